// HistogramBody: the buckets of one figure as the BODY of a reply:
// `figure=F window=W merged=N BUCKET:COUNT...`.
// Owned by the caller; no state of its own.
// Any plain thread (they allocate).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scan/figures.hpp"
#include "scan/histogram.hpp"

namespace stationd::bus {

struct HistogramBody {
  Figure figure = Figure::lateness;
  Window window = Window::since_start;
  /// 1, 2, 4, ...: so many neighbours count as one. What would be too long for a body gets coarser, never
  /// shorter; above 64 the overflow is one with what lies below it.
  std::size_t merged = 1;
  std::vector<BucketCount> buckets;  ///< ascending; bucket / merged

  /// Where the values of one of `buckets` lie: from, up to but not with. INT64_MAX: no end.
  std::int64_t low_ns(std::size_t bucket) const noexcept { return Buckets::low_ns(bucket * merged); }
  std::int64_t end_ns(std::size_t bucket) const noexcept { return Buckets::low_ns((bucket + 1) * merged); }
};

/// Merges buckets until the text has at most `max_bytes`; 128 are always enough.
std::string histogram_text(HistogramBody body, std::size_t max_bytes);

/// Nothing: it is no such text. Words that it does not know are a newer release's.
std::optional<HistogramBody> parse_histogram(std::string_view text);

}  // namespace stationd::bus

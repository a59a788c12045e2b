#include "scan/histogram.hpp"

#include <algorithm>

namespace stationd {

std::size_t Histogram::index(std::int64_t value_ns) noexcept {
  const auto v = static_cast<std::uint64_t>(value_ns);
  if (v < kSub) return static_cast<std::size_t>(v);
  const int top = static_cast<int>(std::bit_width(v)) - 1;  // at least kSubBits
  if (top >= kMaxBits) return kBuckets - 1;
  const int shift = top - kSubBits;
  const std::uint64_t sub = (v >> shift) - kSub;
  return static_cast<std::size_t>(kSub * (static_cast<std::uint64_t>(shift) + 1) + sub);
}

std::int64_t Histogram::upper_ns(std::size_t index) noexcept {
  const std::uint64_t i = index;
  if (i < kSub) return static_cast<std::int64_t>(i);
  const std::uint64_t shift = i / kSub - 1;
  const std::uint64_t low = (i % kSub + kSub) << shift;
  return static_cast<std::int64_t>(low + ((std::uint64_t{1} << shift) - 1));
}

std::int64_t Histogram::quantile_ns(double quantile) const noexcept {
  std::uint64_t total = 0;  // from the buckets themselves: count_ may be ahead of them
  for (const auto& bucket : buckets_) total += bucket.load(std::memory_order_acquire);
  if (total == 0) return 0;
  const double wanted = std::clamp(quantile, 0.0, 1.0) * static_cast<double>(total);
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < kBuckets; ++i) {
    seen += buckets_[i].load(std::memory_order_acquire);
    if (seen != 0 && static_cast<double>(seen) >= wanted)
      return i + 1 == kBuckets ? max_ns() : std::min(upper_ns(i), max_ns());
  }
  return max_ns();
}

}  // namespace stationd

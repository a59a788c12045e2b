// StatsText: how the scans of stations keep their time, as tables, bars and JSON.
// Owned by nobody (pure functions).
// The command's thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dds_bridge/histogram_body.hpp"
#include "dds_bridge/messages.hpp"

namespace stationd::ctl {

struct StationStats {
  bus::ScanStats stats;
  std::vector<bus::HistogramBody> histograms;  ///< empty: not asked for
  std::string realtime;                        ///< rights granted and refused; empty: not known
};

/// Three digits: "870ns", "1.23us", "45.6ms", "1.50s".
std::string precise_duration(std::int64_t ns);

/// A table for the last minute and one since start, then the histograms.
std::vector<std::string> stats_lines(const StationStats& station);

/// Rows of 1, 2, 5, 10, ... with a bar whose length is the logarithm of the count: one late scan in a million
/// shows.
std::vector<std::string> histogram_lines(const bus::HistogramBody& histogram);

/// {"stations":[...]} with all that was published, and the buckets that were asked for.
std::string stats_json(const std::vector<StationStats>& stations);

}  // namespace stationd::ctl

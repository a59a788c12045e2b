#include "ctl/stats_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "config/units.hpp"
#include "ctl/json.hpp"
#include "ctl/table.hpp"
#include "dds_bridge/text.hpp"

namespace stationd::ctl {
namespace {

using bus::count_text;
using bus::printable;

constexpr double kBarColumns = 40;

template <class... T> std::string formatted(const char* format, T... values) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, values...);
  return buffer.data();
}

std::string words(std::string_view name) {
  std::string text(name);
  std::ranges::replace(text, '_', ' ');
  return text;
}

struct Counters {
  std::uint64_t scans, misses, skipped;
};

Counters counters_of(const bus::ScanStats& s, Window window) {
  if (window == Window::since_start) return {s.SCANS, s.DEADLINE_MISSES, s.SKIPPED};
  return {s.MINUTE_SCANS, s.MINUTE_DEADLINE_MISSES, s.MINUTE_SKIPPED};
}

/// A task's own figures are told apart only where it has several stations.
bool told_apart(const bus::ScanStats& s, Figure figure) {
  return s.TASK_STATIONS > 1 || (figure != Figure::task_execution && figure != Figure::task_response);
}

void add_window(std::vector<std::string>& lines, const bus::ScanStats& s, Window window) {
  const Counters n = counters_of(s, window);
  lines.push_back("  " + words(name_of(window)) + ": " + count_text(n.scans, "scan") + ", " +
                  count_text(n.misses, "deadline miss") + ", of them " + count_text(n.skipped, "cycle") +
                  " skipped");
  std::vector<std::vector<std::string>> rows{{"", "min", "mean", "p50", "p99", "p99.9", "max"}};
  for (std::size_t f = 0; f < kFigures; ++f) {
    const auto figure = static_cast<Figure>(f);
    if (!told_apart(s, figure)) continue;
    const Summary& is = s.FIGURES[static_cast<std::size_t>(window)][f];
    std::vector<std::string> row{words(name_of(figure))};
    for (const std::int64_t ns : {is.min_ns, is.mean_ns, is.p50_ns, is.p99_ns, is.p999_ns, is.max_ns})
      row.push_back(is.count == 0 ? "-" : precise_duration(ns));
    rows.push_back(std::move(row));
  }
  for (const std::string& line : aligned(rows, {false, true, true, true, true, true, true}, 0))
    lines.push_back("    " + line);
}

/// The greatest of 1, 2, 5, 10, ... that is at most `ns`; 0 below 1.
std::int64_t step_below(std::int64_t ns) {
  std::int64_t step = 0;
  for (std::int64_t power = 1; power <= ns; power *= 10) {
    for (const std::int64_t digit : {1, 2, 5})
      if (power <= ns / digit) step = power * digit;
    if (power > INT64_MAX / 10) break;
  }
  return step;
}

std::int64_t step_above(std::int64_t step) {
  if (step == 0) return 1;
  const std::int64_t twice = step_below(step * 2);
  return twice > step ? twice : step_below(step * 5 / 2);
}

struct Bar {
  std::int64_t from_ns, to_ns;  // to: INT64_MAX, no end
  std::uint64_t count;
};

std::vector<Bar> bars_of(const bus::HistogramBody& histogram) {
  std::vector<Bar> bars;
  for (const BucketCount& b : histogram.buckets) {
    const std::int64_t low_ns = histogram.low_ns(b.bucket), end_ns = histogram.end_ns(b.bucket);
    if (end_ns == INT64_MAX) {
      bars.push_back({low_ns, end_ns, b.count});
      break;
    }
    const std::int64_t from_ns = step_below(low_ns + (end_ns - 1 - low_ns) / 2);
    if (bars.empty()) bars.push_back({from_ns, step_above(from_ns), 0});
    while (bars.back().from_ns < from_ns)
      bars.push_back({bars.back().to_ns, step_above(bars.back().to_ns), 0});
    bars.back().count += b.count;
  }
  return bars;
}

std::string summary_json(const Summary& s) {
  JsonObject out;
  out.number("count", s.count).number("min_ns", s.min_ns).number("mean_ns", s.mean_ns);
  out.number("p50_ns", s.p50_ns).number("p99_ns", s.p99_ns).number("p999_ns", s.p999_ns);
  return out.number("max_ns", s.max_ns).str();
}

std::string window_json(const bus::ScanStats& s, Window window) {
  const Counters n = counters_of(s, window);
  JsonObject out;
  out.number("scans", n.scans).number("deadline_misses", n.misses).number("skipped", n.skipped);
  for (std::size_t f = 0; f < kFigures; ++f)
    out.raw(name_of(static_cast<Figure>(f)), summary_json(s.FIGURES[static_cast<std::size_t>(window)][f]));
  return out.str();
}

std::string histogram_json(const bus::HistogramBody& histogram) {
  std::vector<std::string> buckets;
  for (const BucketCount& b : histogram.buckets) {
    JsonObject out;
    out.number("from_ns", histogram.low_ns(b.bucket));
    if (histogram.end_ns(b.bucket) != INT64_MAX) out.number("to_ns", histogram.end_ns(b.bucket));
    buckets.push_back(out.number("count", b.count).str());
  }
  return json_array(buckets);
}

}  // namespace

std::string precise_duration(std::int64_t ns) {
  static constexpr std::array<std::pair<double, const char*>, 3> units = {
      {{1e9, "s"}, {1e6, "ms"}, {1e3, "us"}}};
  const auto value = static_cast<double>(ns);
  for (const auto& [unit, name] : units) {
    const double in_unit = value / unit;
    if (in_unit < 0.9995) continue;
    const int decimals = in_unit < 9.995 ? 2 : in_unit < 99.95 ? 1 : 0;
    return formatted("%.*f%s", decimals, in_unit, name);
  }
  return formatted("%.0fns", value);
}

std::vector<std::string> stats_lines(const StationStats& station) {
  const bus::ScanStats& s = station.stats;
  std::vector<std::string> lines{printable(s.STATION) + ": task " + printable(s.TASK) + ", " +
                                 count_text(s.TASK_STATIONS, "station") + ", every " +
                                 config::duration_text(s.PERIOD_NS)};
  if (!station.realtime.empty()) lines.push_back("  real-time rights: " + printable(station.realtime));
  add_window(lines, s, Window::last_minute);
  add_window(lines, s, Window::since_start);
  for (const bus::HistogramBody& histogram : station.histograms) {
    lines.push_back("  " + words(name_of(histogram.figure)) + ", " + words(name_of(histogram.window)) +
                    (histogram.buckets.empty() ? ": nothing yet" : ""));
    for (const std::string& line : histogram_lines(histogram)) lines.push_back("    " + line);
  }
  return lines;
}

std::vector<std::string> histogram_lines(const bus::HistogramBody& histogram) {
  const std::vector<Bar> bars = bars_of(histogram);
  std::uint64_t total = 0, most = 0, seen = 0;
  for (const Bar& bar : bars) {
    total += bar.count;
    most = std::max(most, bar.count);
  }
  std::vector<std::vector<std::string>> rows;
  for (const Bar& bar : bars) {
    seen += bar.count;
    const double length = std::log1p(static_cast<double>(bar.count)) / std::log1p(static_cast<double>(most));
    // Rounded down: 100 % means that nothing follows.
    const double percent = std::floor(1e5 * static_cast<double>(seen) / static_cast<double>(total)) / 1e3;
    const std::string to = bar.to_ns == INT64_MAX ? "or more" : "to " + precise_duration(bar.to_ns);
    rows.push_back({precise_duration(bar.from_ns), to, std::to_string(bar.count),
                    formatted("%.3f%%", percent),
                    std::string(static_cast<std::size_t>(std::ceil(length * kBarColumns)), '#')});
  }
  return aligned(rows, {true, false, true, true, false}, 0);
}

std::string stats_json(const std::vector<StationStats>& stations) {
  std::vector<std::string> values;
  for (const StationStats& station : stations) {
    const bus::ScanStats& s = station.stats;
    JsonObject out;
    out.text("station", s.STATION).text("task", s.TASK).number("task_stations", s.TASK_STATIONS);
    out.number("period_ns", s.PERIOD_NS).number("source_time_ns", s.SOURCE_TIME);
    for (const Window window : {Window::since_start, Window::last_minute})
      out.raw(name_of(window), window_json(s, window));
    out.text("realtime", station.realtime);
    if (!station.histograms.empty()) {
      JsonObject histograms;
      for (const bus::HistogramBody& h : station.histograms)
        histograms.raw(name_of(h.figure), histogram_json(h));
      out.raw("histograms", histograms.str());
    }
    values.push_back(out.str());
  }
  return JsonObject().raw("stations", json_array(values)).str();
}

}  // namespace stationd::ctl

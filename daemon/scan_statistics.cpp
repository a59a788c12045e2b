#include "daemon/scan_statistics.hpp"

#include <algorithm>

namespace stationd {
namespace {

bus::ScanStats message_of(const TaskStatistics& statistics, std::size_t place) {
  const Task& task = statistics.task();
  bus::ScanStats m;
  m.STATION = task.stations()[place]->name();
  m.TASK = task.options().name;
  m.TASK_STATIONS = static_cast<std::uint32_t>(task.stations().size());
  m.PERIOD_NS = task.options().period_ns;
  m.SCANS = statistics.scans(Window::since_start);
  m.DEADLINE_MISSES = statistics.deadline_misses(Window::since_start);
  m.SKIPPED = statistics.skipped(Window::since_start);
  m.MINUTE_SCANS = statistics.scans(Window::last_minute);
  m.MINUTE_DEADLINE_MISSES = statistics.deadline_misses(Window::last_minute);
  m.MINUTE_SKIPPED = statistics.skipped(Window::last_minute);
  for (std::size_t w = 0; w < kWindows; ++w)
    for (std::size_t f = 0; f < kFigures; ++f)
      m.FIGURES[w][f] = statistics.figure(place, static_cast<Figure>(f)).summary(static_cast<Window>(w));
  return m;
}

}  // namespace

void ScanStatistics::add(const Task& task) { entries_.push_back(std::make_unique<Entry>(task)); }

void ScanStatistics::collect(std::int64_t now_ns) {
  for (const auto& entry : entries_) {
    const std::lock_guard lock(entry->mutex);
    entry->statistics.collect(now_ns);
    entry->lateness = entry->statistics.figure(0, Figure::lateness).summary(Window::since_start);
  }
}

std::vector<bus::ScanStats> ScanStatistics::messages(std::int64_t utc_ns) const {
  std::vector<bus::ScanStats> all;
  for (const auto& entry : entries_) {
    const std::lock_guard lock(entry->mutex);
    for (std::size_t i = 0; i < entry->statistics.task().stations().size(); ++i) {
      all.push_back(message_of(entry->statistics, i));
      all.back().SOURCE_TIME = utc_ns;
    }
  }
  return all;
}

Summary ScanStatistics::lateness(const Task& task) const {
  for (const auto& entry : entries_) {
    if (&entry->statistics.task() != &task) continue;
    const std::lock_guard lock(entry->mutex);
    return entry->lateness;
  }
  return {};
}

std::vector<BucketCount> ScanStatistics::buckets(const Station& station, Figure figure, Window window) const {
  for (const auto& entry : entries_) {
    const std::vector<Station*>& stations = entry->statistics.task().stations();
    const auto at = std::ranges::find(stations, &station);
    if (at == stations.end()) continue;
    const std::lock_guard lock(entry->mutex);
    return entry->statistics.figure(static_cast<std::size_t>(at - stations.begin()), figure).buckets(window);
  }
  return {};
}

}  // namespace stationd

#include "daemon/miss_report.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

namespace stationd {
namespace {

constexpr std::int64_t kLineEveryNs = 1'000'000'000;

std::string us(std::int64_t ns) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f us", static_cast<double>(ns) / 1e3);
  return text.data();
}

/// The phase that took longest, for people who look for the culprit.
std::pair<const char*, std::int64_t> longest_phase(const CycleRecord& r) {
  const std::array<std::pair<const char*, std::int64_t>, 6> phases = {{{"waking", r.lateness_ns},
                                                                       {"latch", r.latch_ns},
                                                                       {"execute", r.execute_ns},
                                                                       {"commit", r.commit_ns},
                                                                       {"publish", r.publish_ns},
                                                                       {"service", r.service_ns}}};
  return *std::max_element(phases.begin(), phases.end(),
                           [](auto& a, auto& b) { return a.second < b.second; });
}

}  // namespace

MissReport::MissReport(std::string task, std::string stations)
    : task_(std::move(task)), stations_(std::move(stations)) {}

void MissReport::add(const CycleRecord& record) {
  if (!worst_ || record.response_ns > worst_->response_ns) worst_ = record;
}

std::optional<MissReport::Line> MissReport::due(std::int64_t now_ns, std::uint64_t misses) {
  if (misses == reported_ || now_ns < next_line_ns_) return std::nullopt;
  const std::uint64_t count = misses - reported_;
  const CycleRecord r = worst_.value_or(CycleRecord{});
  const auto [phase, phase_ns] = longest_phase(r);
  const std::int64_t execution_ns = r.latch_ns + r.execute_ns + r.commit_ns;
  Line line;
  line.text = "deadline miss: task " + task_ + " (" + stations_ + "), " + std::to_string(count) +
              (count == 1 ? " miss" : " misses") + " since the last line, " + std::to_string(misses) +
              " in all; worst: scan " + std::to_string(r.scan) + ", lateness " + us(r.lateness_ns) +
              ", execution " + us(execution_ns) + ", due to commit " + us(r.response_ns) +
              ", longest: " + phase + " " + us(phase_ns) + ", skipped " + std::to_string(r.skipped);
  line.fields = {{"STATIOND_EVENT", "deadline_miss"},
                 {"STATIOND_TASK", task_},
                 {"STATIOND_STATIONS", stations_},
                 {"STATIOND_SCAN", std::to_string(r.scan)},
                 {"STATIOND_COUNT", std::to_string(count)},
                 {"STATIOND_MISSES", std::to_string(misses)},
                 {"STATIOND_LATENESS_NS", std::to_string(r.lateness_ns)},
                 {"STATIOND_EXECUTION_NS", std::to_string(execution_ns)},
                 {"STATIOND_RESPONSE_NS", std::to_string(r.response_ns)},
                 {"STATIOND_PHASE", phase}};
  reported_ = misses;
  worst_.reset();
  next_line_ns_ = now_ns + kLineEveryNs;
  return line;
}

}  // namespace stationd

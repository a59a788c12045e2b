#include "daemon/miss_report.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>
#include <utility>

namespace stationd {
namespace {

constexpr std::int64_t kLineEveryNs = 1'000'000'000;

std::string us(std::int64_t ns) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f us", static_cast<double>(ns) / 1e3);
  return text.data();
}

struct Culprit {
  std::string_view phase;  ///< "waking", or the phase's name
  std::int64_t took_ns;
};

/// What the miss is down to. What follows the commit counts only where the outputs were in time: then it
/// made the next cycles be skipped.
Culprit culprit_of(const CycleRecord& r) {
  const std::array<Culprit, 6> all = {{{"waking", r.lateness_ns},
                                       {name_of(Phase::latch), r.latch_ns},
                                       {name_of(Phase::execute), r.execute_ns},
                                       {name_of(Phase::commit), r.commit_ns},
                                       {name_of(Phase::publish), r.publish_ns},
                                       {name_of(Phase::service), r.service_ns}}};
  const auto* const end = r.committed_late ? all.begin() + 4 : all.end();
  return *std::max_element(all.begin(), end, [](auto& x, auto& y) { return x.took_ns < y.took_ns; });
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

MissReport::MissReport(std::string task, std::vector<std::string> stations)
    : task_(std::move(task)), stations_(std::move(stations)) {}

void MissReport::add(const CycleRecord& record) {
  if (!worst_ || record.response_ns > worst_->response_ns) worst_ = record;
}

std::optional<MissReport::Line> MissReport::due(std::int64_t now_ns, std::uint64_t misses) {
  if (misses == reported_ || now_ns < next_line_ns_) return std::nullopt;
  const std::uint64_t count = misses - reported_;
  const CycleRecord r = worst_.value_or(CycleRecord{});
  const Culprit culprit = culprit_of(r);
  const std::int64_t execution_ns = r.latch_ns + r.execute_ns + r.commit_ns;
  const std::string names = joined(stations_);
  const std::string slowest = r.slowest < stations_.size() ? stations_[r.slowest] : "";
  std::string why = "woken late by " + us(culprit.took_ns);
  if (culprit.phase != "waking") {
    why = std::string(culprit.phase) + " took " + us(culprit.took_ns);
    if (stations_.size() > 1) why += " (most: " + slowest + ", execution " + us(r.slowest_ns) + ")";
  }
  Line line;
  line.text = "deadline miss: task " + task_ + " (" + names + "), " + std::to_string(count) +
              (count == 1 ? " miss" : " misses") + " since the last line, " + std::to_string(misses) +
              " in all; worst: scan " + std::to_string(r.scan) + ", " + why + "; lateness " +
              us(r.lateness_ns) + ", execution " + us(execution_ns) + ", due to commit " + us(r.response_ns) +
              ", skipped " + std::to_string(r.skipped);
  line.fields = {{"STATIOND_EVENT", "deadline_miss"},
                 {"STATIOND_TASK", task_},
                 {"STATIOND_STATIONS", names},
                 {"STATIOND_SLOWEST", slowest},
                 {"STATIOND_SCAN", std::to_string(r.scan)},
                 {"STATIOND_COUNT", std::to_string(count)},
                 {"STATIOND_MISSES", std::to_string(misses)},
                 {"STATIOND_SKIPPED", std::to_string(r.skipped)},
                 {"STATIOND_LATENESS_NS", std::to_string(r.lateness_ns)},
                 {"STATIOND_EXECUTION_NS", std::to_string(execution_ns)},
                 {"STATIOND_RESPONSE_NS", std::to_string(r.response_ns)},
                 {"STATIOND_PHASE", std::string(culprit.phase)},
                 {"STATIOND_PHASE_NS", std::to_string(culprit.took_ns)}};
  reported_ = misses;
  worst_.reset();
  next_line_ns_ = now_ns + kLineEveryNs;
  return line;
}

}  // namespace stationd

// Running a controller: start, stop, progress, housekeeping. How it is built: controller_build.cpp.
#include "daemon/controller.hpp"

#include <algorithm>
#include <utility>

#include "scan/clock.hpp"
#include "scan/error.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kScanEndLimitNs = 500'000'000;
constexpr std::int64_t kReportLimitNs = 2'000'000'000;  // past any line's turn

std::string join(const std::vector<RtGrant>& grants) {
  std::string text;
  for (const RtGrant& g : grants)
    text += (text.empty() ? "" : ", ") + g.what + (g.granted ? " granted" : " refused");
  return text.empty() ? "none asked for" : text;
}

}  // namespace

Controller::~Controller() { stop(); }

void Controller::name_unwatched_devices() {
  for (const auto& device : devices_) {
    const io::DeviceOptions& options = device->options();
    if (options.kind != io::DeviceKind::modbus || options.heartbeat_period_ns > 0) continue;
    log_.warning("device " + options.name +
                 " has no heartbeat: unless it watches its connection by itself, its outputs "
                 "stay as they are when this host dies");
  }
}

std::vector<RtGrant> Controller::start_scans() {
  name_unwatched_devices();
  retain_->start();
  bridge_->start();
  std::vector<RtGrant> grants = {lock_memory()};
  for (RunningTask& t : tasks_) {
    t.thread = std::make_unique<RtThread>(*t.task, t.rt, utc_offset_ns_);
    for (RtGrant& g : t.thread->start()) grants.push_back(std::move(g));
    t.progress_ns = monotonic_ns();
  }
  log_grants(grants);
  return grants;
}

void Controller::log_grants(const std::vector<RtGrant>& grants) {
  log_.info("real-time rights: " + join(grants));
  bool refused = false;
  for (const RtGrant& g : grants) {
    if (g.granted) continue;
    refused = true;
    log_.warning(g.what + " refused: " + g.reason);
  }
  if (refused)
    log_.warning("running without all real-time rights: scans may be late when the machine is busy");
  const std::lock_guard lock(realtime_mutex_);
  realtime_ = join(grants);
}

void Controller::start_field() {
  for (auto& device : devices_) device->start();
}

bool Controller::stop() noexcept {
  if (std::exchange(stopped_, true)) return true;
  for (auto& device : devices_) device->request_stop();  // safe values first, whatever becomes of the scans
  bool ended = true;
  for (RunningTask& t : tasks_)
    if (t.thread && !t.thread->stop(kScanEndLimitNs)) ended = false;
  for (auto& device : devices_) device->stop();
  if (retain_) retain_->stop();
  if (bridge_) bridge_->stop();
  report_misses(monotonic_ns() + kReportLimitNs);
  return ended;
}

bool Controller::first_scans_done() const {
  return std::all_of(tasks_.begin(), tasks_.end(),
                     [](const RunningTask& t) { return t.task->figures().scans.load() > 0; });
}

bool Controller::made_progress(std::int64_t now_ns) {
  bool all = true;
  for (RunningTask& t : tasks_) {
    const std::uint64_t scans = t.task->figures().scans.load(std::memory_order_relaxed);
    if (scans != t.seen_scans) {
      t.seen_scans = scans;
      t.progress_ns = now_ns;
    }
    if (now_ns - t.progress_ns <= t.watchdog_ns + t.task->options().period_ns) continue;
    all = false;
    for (Station* s : t.task->stations()) s->port().permit.store(false, std::memory_order_release);
  }
  return all;
}

std::int64_t Controller::longest_wait_ns() const {
  std::int64_t longest_ns = 0;
  for (const RunningTask& t : tasks_)
    longest_ns = std::max(longest_ns, t.task->options().period_ns + t.task->options().phase_ns);
  return longest_ns;
}

void Controller::refuse_duplicate() const {
  const std::string name = bridge_->duplicate_station();
  if (name.empty()) return;
  throw AlreadyRunning("station \"" + name + "\" is already run by another daemon in cell \"" +
                       configuration_.bus.cell + "\", domain " + std::to_string(configuration_.bus.domain) +
                       ": give it another name or stop the other");
}

void Controller::housekeep(std::int64_t now_ns) {
  utc_offset_ns_.store(stationd::utc_offset_ns(), std::memory_order_relaxed);
  report_misses(now_ns);
}

void Controller::report_misses(std::int64_t now_ns) {
  for (RunningTask& t : tasks_) {
    CycleRecord record;
    while (t.task->misses().pop(record)) t.report->add(record);
    if (const auto line =
            t.report->due(now_ns, t.task->figures().deadline_misses.load(std::memory_order_acquire)))
      log_.line(LogSeverity::warning, line->text, line->fields);
  }
}

std::string Controller::status_line() const {
  std::uint64_t scans = 0;
  std::uint64_t misses = 0;
  for (const RunningTask& t : tasks_) {
    scans += t.task->figures().scans.load(std::memory_order_relaxed);
    misses += t.task->figures().deadline_misses.load(std::memory_order_relaxed);
  }
  return std::to_string(stations_.size()) + " stations, " + std::to_string(scans) + " scans, " +
         std::to_string(misses) + " deadline misses";
}

}  // namespace stationd

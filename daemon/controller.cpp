// Running a controller: start, stop, progress, housekeeping. How it is built: controller_build.cpp.
#include "daemon/controller.hpp"

#include <sys/file.h>
#include <unistd.h>

#include <algorithm>

#include "scan/error.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kScanEndLimitNs = 500'000'000;

std::string join(const std::vector<RtGrant>& grants) {
  std::string text;
  for (const RtGrant& g : grants)
    text += (text.empty() ? "" : ", ") + g.what + (g.granted ? " granted" : " refused");
  return text.empty() ? "none asked for" : text;
}

}  // namespace

Controller::~Controller() {
  stop();
  if (lock_fd_ >= 0) close(lock_fd_);
}

void Controller::name_unwatched_devices() {
  for (const auto& device : devices_) {
    const io::DeviceOptions& options = device->options();
    if (options.kind != io::DeviceKind::modbus || options.heartbeat_period_ns > 0) continue;
    log_.warning("device " + options.name +
                 " has no heartbeat: unless it watches its connection by itself, its outputs "
                 "stay as they are when this host dies");
  }
}

std::vector<RtGrant> Controller::start() {
  name_unwatched_devices();
  retain_->start();
  bridge_->start();
  for (auto& device : devices_) device->start();
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

bool Controller::stop() noexcept {
  bool ended = true;
  for (RunningTask& t : tasks_)
    if (t.thread && !t.thread->stop(kScanEndLimitNs)) ended = false;
  for (auto& station : stations_) station->port().permit.store(false);
  for (auto& device : devices_) device->request_stop();
  for (auto& device : devices_) device->stop();
  if (retain_) retain_->stop();
  if (bridge_) bridge_->stop();
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
    if (now_ns - t.progress_ns > t.watchdog_ns + t.task->options().period_ns) all = false;
  }
  return all;
}

std::string Controller::duplicate_station() const { return bridge_->duplicate_station(); }

void Controller::housekeep(std::int64_t now_ns) {
  utc_offset_ns_.store(stationd::utc_offset_ns(), std::memory_order_relaxed);
  for (RunningTask& t : tasks_) {
    CycleRecord record;
    while (t.task->misses().pop(record)) t.report->add(record);
    if (const auto line =
            t.report->due(now_ns, t.task->figures().deadline_misses.load(std::memory_order_relaxed)))
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

// Running a controller: start, stop, progress, housekeeping. How it is built: controller_build.cpp.
#include "daemon/controller.hpp"

#include <algorithm>
#include <utility>

#include "dds_bridge/text.hpp"
#include "scan/clock.hpp"
#include "scan/codes.hpp"
#include "scan/error.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kScanEndLimitNs = 500'000'000;
constexpr std::int64_t kStatisticsEveryNs = 1'000'000'000;
constexpr std::int64_t kDevicePatienceNs = 400'000'000;
constexpr std::int64_t kReportLimitNs = 2'000'000'000;  // past any line's turn

/// "refused: SCHED_FIFO 80; granted: memory lock, CPU 1"
std::string join(const std::vector<RtGrant>& grants) {
  std::string refused;
  std::string granted;
  for (const RtGrant& g : grants) {
    std::string& list = g.granted ? granted : refused;
    list += (list.empty() ? "" : ", ") + g.what;
  }
  if (!refused.empty()) refused = "refused: " + refused;
  if (!granted.empty()) granted = "granted: " + granted;
  return refused + (refused.empty() || granted.empty() ? "" : "; ") + granted;
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
  const bool real_time =
      std::any_of(tasks_.begin(), tasks_.end(), [](const RunningTask& t) { return t.rt.priority > 0; });
  if (real_time && configuration_.keep_cpus_awake) {
    cpus_awake_ = std::make_unique<CpusAwake>();
    grants.push_back(cpus_awake_->grant());
  }
  for (RunningTask& t : tasks_) {
    t.thread = std::make_unique<RtThread>(*t.task, t.rt, utc_offset_ns_);
    for (RtGrant& g : t.thread->start()) grants.push_back(std::move(g));
  }
  announce_refusals(grants);
  start_watchdog(grants);
  log_grants(grants);
  return grants;
}

/// One event for each station: rights are the daemon's. Before the watchdog takes its ring over.
void Controller::announce_refusals(const std::vector<RtGrant>& grants) {
  const auto refused =
      std::count_if(grants.begin(), grants.end(), [](const RtGrant& g) { return !g.granted; });
  if (refused == 0) return;
  const std::int64_t utc_ns = monotonic_ns() + utc_offset_ns_;
  for (const auto& station : stations_)
    station->port().announce(code::realtime_refused, Severity::warning, refused, utc_ns);
}

void Controller::start_watchdog(std::vector<RtGrant>& grants) {
  std::vector<RtWatchdog::Watched> watched;
  for (RunningTask& t : tasks_) watched.push_back({t.task.get(), t.thread.get(), t.watchdog_ns});
  watchdog_ = std::make_unique<RtWatchdog>(std::move(watched));
  for (RtGrant& g : watchdog_->start(utc_offset_ns_)) grants.push_back(std::move(g));
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
  const std::int64_t patient_until_ns = monotonic_ns() + kDevicePatienceNs;
  for (auto& device : devices_) device->request_stop();  // safe values first, whatever becomes of the scans
  bool ended = true;
  for (RunningTask& t : tasks_)
    if (t.thread && !t.thread->stop(kScanEndLimitNs)) ended = false;
  if (watchdog_) watchdog_->stop();
  for (auto& device : devices_)
    if (!device->ended_by(patient_until_ns)) device->interrupt();
  for (auto& device : devices_) device->stop();
  if (retain_) retain_->stop();
  if (bridge_) bridge_->stop();
  report_misses(monotonic_ns() + kReportLimitNs);
  log_.report_dropped(monotonic_ns() + kReportLimitNs);
  return ended;
}

bool Controller::first_scans_done() const {
  return std::all_of(tasks_.begin(), tasks_.end(),
                     [](const RunningTask& t) { return t.task->figures().scans.load() > 0; });
}

bool Controller::alive(std::int64_t now_ns) const {
  return !watchdog_->stalled(now_ns) && !(configuration_.restart_on_stuck && watchdog_->any_stuck());
}

void Controller::report_stuck() {
  RtWatchdog::Report report;
  while (watchdog_ && watchdog_->reports().pop(report)) {
    const Task& task = *tasks_[report.task].task;
    const std::string idle = std::to_string(report.idle_ns / 1'000'000) + " ms";
    std::string text = "task " + task.options().name;
    if (report.stuck) {
      text += ": no progress for " + idle + "; its outputs are made safe";
      if (report.station >= 0)
        text += "; the program of station " +
                task.stations()[static_cast<std::size_t>(report.station)]->name() + " does not return";
      if (report.demoted) text += "; its thread has no real-time rights until it moves again";
    } else {
      text += ": moves again; its stations are in FAULT until reset";
    }
    log_.line(
        report.stuck ? LogSeverity::error : LogSeverity::warning, text,
        {{"STATIOND_EVENT", report.stuck ? "stuck" : "unstuck"}, {"STATIOND_TASK", task.options().name}});
  }
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
  report_stuck();
  tell_statistics(now_ns);
  log_.report_dropped(now_ns);
}

/// Once a second, and at once to who has just begun to listen; nothing is written for nobody.
void Controller::tell_statistics(std::int64_t now_ns) {
  const int readers = bridge_->stats_readers();
  const bool newcomer = readers > statistics_readers_;
  statistics_readers_ = readers;
  if (now_ns < next_statistics_ns_ && !newcomer) return;
  next_statistics_ns_ = now_ns + kStatisticsEveryNs;
  statistics_.collect(now_ns);
  if (readers == 0) return;
  for (const bus::ScanStats& stats : statistics_.messages(now_ns + utc_offset_ns_)) bridge_->publish(stats);
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
  return bus::count_text(stations_.size(), "station") + ", " + bus::count_text(scans, "scan") + ", " +
         bus::count_text(misses, "deadline miss");
}

}  // namespace stationd

// Controller: everything that one configuration file asks for, built and connected: stations, tasks,
// devices, bus, stores.
// Owned by main(); the one place that composes the rest.
// Built, started and stopped by the main thread; the threads it starts are in docs/architecture.md.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "daemon/log.hpp"
#include "daemon/miss_report.hpp"
#include "daemon/retain_thread.hpp"
#include "daemon/scan_statistics.hpp"
#include "daemon/state_lock.hpp"
#include "dds_bridge/station_bridge.hpp"
#include "io/device.hpp"
#include "io/plant/simulated_backend.hpp"
#include "programs/programs.hpp"
#include "scan/rt_thread.hpp"
#include "scan/rt_watchdog.hpp"
#include "scan/task.hpp"

namespace stationd {

/// The state directory is in use by another daemon of the same controller.
class AlreadyRunning : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Controller {
 public:
  /// Builds all, connects all; nothing runs yet. Throws SetupError, AlreadyRunning, bus::BusError.
  Controller(const config::Configuration& configuration, Log& log, ProgramList programs = all_programs());
  ~Controller();
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

  /// Bus and scans; no device is touched yet. What the kernel refused is logged and returned; throws like the
  /// constructor.
  std::vector<RtGrant> start_scans();
  /// The devices, once it is known that nobody else drives them (kListenNs after start_scans()).
  void start_field();
  static constexpr std::int64_t kListenNs = 450'000'000;
  /// Outputs go safe, scans end, retained tags are saved, peers are told. False: a scan thread did not end,
  /// and
  /// what it uses must not be freed.
  bool stop() noexcept;

  /// True once every task has run its first scan.
  bool first_scans_done() const;
  /// Longest time from start to a first scan: period and phase.
  std::int64_t longest_wait_ns() const;
  /// Whether the service manager may be told that all is well: the watchdog thread runs, and with
  /// restart_on_stuck no task is stuck.
  bool alive(std::int64_t now_ns) const;
  /// Throws AlreadyRunning when another live daemon was heard with a station of one of our names.
  void refuse_duplicate() const;
  /// Housekeeping, a few times a second: log lines about deadline misses, UTC offset,
  /// statistics.
  void housekeep(std::int64_t now_ns);
  /// "1234 scans, 0 deadline misses", for the service manager.
  std::string status_line() const;

 private:
  struct RunningTask {
    std::unique_ptr<Task> task;
    std::unique_ptr<RtThread> thread;
    std::unique_ptr<MissReport> report;
    std::int64_t watchdog_ns = 0;
    RtOptions rt;
  };

  void lock_state_directory();
  void build_station(const config::StationConfig& station);
  void map_tags(Station& station, const config::StationConfig& config);
  void link_devices(Station& station, std::size_t index);
  void restore(Station& station);
  void build_devices();
  void build_device(const io::DeviceOptions& options);
  std::unique_ptr<io::Backend> make_backend(const io::DeviceOptions& options,
                                            const std::vector<io::Point>& points);
  void build_tasks();
  void build_bus();
  void name_unwatched_devices();
  void log_grants(const std::vector<RtGrant>& grants);
  bus::TaskFigures figures_of(const Task& task);

  void report_misses(std::int64_t now_ns);
  void announce_refusals(const std::vector<RtGrant>& grants);
  void start_watchdog(std::vector<RtGrant>& grants);
  void report_stuck();
  void tell_statistics(std::int64_t now_ns);

  const config::Configuration& configuration_;
  Log& log_;
  ProgramList programs_;
  StateLock lock_;
  bool stopped_ = false;
  MonotonicStopwatch stopwatch_;
  std::atomic<std::int64_t> utc_offset_ns_;
  std::mutex realtime_mutex_;
  std::string realtime_;  // what was granted and refused, for Status
  std::vector<std::unique_ptr<Station>> stations_;
  std::unique_ptr<RetainThread> retain_;
  std::shared_ptr<io::SharedPlant> plant_;
  std::vector<std::unique_ptr<io::Device>> devices_;
  std::vector<RunningTask> tasks_;
  std::unique_ptr<CpusAwake> cpus_awake_;
  std::unique_ptr<RtWatchdog> watchdog_;
  ScanStatistics statistics_;
  std::int64_t next_statistics_ns_ = 0;
  int statistics_readers_ = 0;
  std::unique_ptr<bus::Bus> bus_;
  std::unique_ptr<bus::StationBridge> bridge_;
};

}  // namespace stationd

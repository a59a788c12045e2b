// StationBridge: joins stations' links and ports to the bus: PVs out and in, events, orders, replies, Status.
// Owned by the daemon; outlives the scan threads' last cycle.
// Threads: bus-out (woken by an eventfd after each commit), event writer, and the Bus's bus-in thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "dds_bridge/bus.hpp"
#include "scan/station.hpp"

namespace stationd::bus {

/// What the scan side tells the bridge of a station's task, read without locks from any thread.
struct TaskFigures {
  std::int64_t period_ns = 0;
  std::int64_t lateness_p99_ns = 0;
  std::int64_t lateness_max_ns = 0;
  std::string realtime;
};

struct BridgedStation {
  Station* station = nullptr;
  std::function<TaskFigures()> figures;
};

struct BridgeOptions {
  std::string controller;
  std::int64_t status_period_ns = 100'000'000;  ///< Status is repeated at least so often
};

/// A line for the log, from any of the bridge's threads: severity 0 debug .. 3 error.
using LogSink = std::function<void(int severity, const std::string& text)>;

class StationBridge {
 public:
  /// Set-up from a plain thread: makes writers, readers, threads (not yet running). Throws BusError.
  StationBridge(Bus& bus, BridgeOptions options, std::vector<BridgedStation> stations, LogSink log);
  ~StationBridge();

  /// The eventfd that a scan thread writes 1 to after each commit.
  int wake_fd() const noexcept;
  /// Starts the threads and the bus. From a plain thread.
  void start();
  /// Sends what waits (bounded to 500 ms), announces nothing more, joins the threads.
  void stop() noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stationd::bus

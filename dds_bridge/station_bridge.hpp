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
#include "scan/figures.hpp"
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
  /// The buckets of one of its figures, for whoever asks (`histogram FIGURE`); bus-in thread. May be unset.
  std::function<std::vector<BucketCount>(Figure, Window)> histogram = {};
};

struct BridgeOptions {
  std::string controller;
  std::int64_t status_period_ns = 100'000'000;  ///< Status is repeated at least so often
  /// After start() nothing is published and no Start or Msg is taken for so long, while the bridge looks
  /// whether another daemon publishes the Status of one of its stations. Stop is always taken. 0: not at all.
  std::int64_t listen_ns = 400'000'000;
  /// A duplicate found within this time after start() makes this side, the newcomer, give way; see
  /// duplicate_station(). One that turns up later (two halves of a network that meet again) is logged on both
  /// sides.
  std::int64_t newcomer_ns = 3'000'000'000;
  std::size_t event_backlog = 4096;  ///< events kept while readers do not take them; then the oldest are lost
};

/// Counted since start; exact, while the log is throttled.
struct BridgeFigures {
  std::uint64_t orders_refused =
      0;  ///< Start, Stop, Msg that named something unknown or contradicted their topic
  std::uint64_t orders_busy = 0;     ///< Start and Msg that found the station's request ring full
  std::uint64_t events_waiting = 0;  ///< not yet taken over by DDS
  std::uint64_t events_lost = 0;     ///< pushed out of the backlog; their gap in SEQ shows
  std::uint64_t replies_lost = 0;    ///< written without success
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

  /// The station that another daemon in the cell runs as well, found while this one was new: give up, with a
  /// message and an exit status. The bridge publishes nothing more. Empty: none. Any thread.
  std::string duplicate_station() const;
  /// Any plain thread. Who listens to ScanStats, and what they are told; nothing while Status is not, either.
  int stats_readers() const;
  void publish(const ScanStats& stats);
  BridgeFigures figures() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stationd::bus

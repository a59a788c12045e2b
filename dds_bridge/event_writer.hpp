// EventWriter: writes events to the bus from a thread of its own, so that a slow reader of theirs delays
// nothing else.
// Private to dds_bridge; owned by the bridge.
// put() by the bus-out thread, the rest by the owner.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>

#include "dds_bridge/bridge_context.hpp"

namespace stationd::bus {

class EventWriter {
 public:
  explicit EventWriter(Context& context) : context_(context) {}
  ~EventWriter();
  EventWriter(const EventWriter&) = delete;
  EventWriter& operator=(const EventWriter&) = delete;

  void start();
  /// Takes an event over. A full backlog loses its oldest, counted and logged.
  void put(Gse event);
  /// Writes what waits, until `deadline_ns` (CLOCK_MONOTONIC), then ends the thread.
  void stop(std::int64_t deadline_ns) noexcept;
  std::size_t waiting() const;

 private:
  void run();

  Context& context_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Gse> backlog_;
  bool end_ = false;
  std::int64_t deadline_ns_ = 0;
  std::thread thread_;
};

}  // namespace stationd::bus

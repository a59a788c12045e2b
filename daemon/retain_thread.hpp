// RetainThread: writes stations' retained tags to disk when they change, so that no scan ever waits for it.
// Owned by the controller.
// A plain thread of its own; may block on the disk.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "daemon/retain_store.hpp"
#include "scan/station.hpp"

namespace stationd {

/// A line for the log, from the retain thread: severity 0 debug .. 3 error.
using RetainLog = std::function<void(int severity, const std::string& text)>;

class RetainThread {
 public:
  /// `interval_ns`: changed values are on disk at most so late; urgent ones (Cycle::save_retained) within
  /// some 10 ms.
  RetainThread(RetainLog log, std::int64_t interval_ns);
  ~RetainThread();
  RetainThread(const RetainThread&) = delete;
  RetainThread& operator=(const RetainThread&) = delete;
  /// Before start(). The target already holds this start's epoch.
  void add(Station& station, std::unique_ptr<RetainTarget> target);
  void start();
  /// Saves what is not saved yet and joins. After the scan threads' end.
  void stop() noexcept;

  /// One look at all stations at now_ns; the thread's body, and what tests call without a thread. `last`:
  /// whatever is not saved yet is, however recent the last save.
  void pass(std::int64_t now_ns, bool last) noexcept;

 private:
  struct Item {
    Station* station;
    std::unique_ptr<RetainTarget> target;
    std::int64_t last_save_ns = 0;
    bool unsaved = false;
    bool failing = false;
  };
  void loop() noexcept;
  void look_at(Item& item, std::int64_t now_ns, bool last) noexcept;
  void save(Item& item, std::int64_t now_ns);

  RetainLog log_;
  std::int64_t interval_ns_;
  std::vector<Item> items_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace stationd

// RetainThread: writes stations' retained tags to disk when they change, so that no scan ever waits for it.
// Owned by the controller.
// A plain thread of its own; may block on the disk.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "daemon/log.hpp"
#include "daemon/retain_store.hpp"
#include "scan/station.hpp"

namespace stationd {

class RetainThread {
 public:
  /// `interval_ns`: changed values are on disk at most so late; urgent ones (Cycle::save_retained) within
  /// some 10 ms.
  RetainThread(Log& log, std::int64_t interval_ns);
  ~RetainThread();
  /// Before start(). The store already holds this start's epoch.
  void add(Station& station, std::unique_ptr<RetainStore> store);
  void start();
  /// Saves what is not saved yet and joins. After the scan threads' end.
  void stop() noexcept;

 private:
  struct Item {
    Station* station;
    std::unique_ptr<RetainStore> store;
    std::int64_t last_save_ns = 0;
    bool unsaved = false;
    bool failing = false;
  };
  void loop() noexcept;
  void look_at(Item& item, std::int64_t now_ns, bool last) noexcept;
  void save(Item& item, std::int64_t now_ns);

  Log& log_;
  std::int64_t interval_ns_;
  std::vector<Item> items_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace stationd

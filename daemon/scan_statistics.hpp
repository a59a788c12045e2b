// ScanStatistics: the statistics of all tasks: collected once a second, told to the bus and to who asks.
// Owned by the controller.
// Set-up by one thread; then collect() and message() by housekeeping, the rest by any plain thread.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "dds_bridge/messages.hpp"
#include "scan/statistics.hpp"

namespace stationd {

class ScanStatistics {
 public:
  /// Set-up. `task` must outlive it.
  void add(const Task& task);

  /// Takes over what the scans recorded.
  void collect(std::int64_t now_ns);
  /// Of each station, as the bus tells it.
  std::vector<bus::ScanStats> messages(std::int64_t utc_ns) const;
  /// Since start, as of the last collect().
  Summary lateness(const Task& task) const;
  /// The same, bucket by bucket.
  std::vector<BucketCount> buckets(const Station& station, Figure figure, Window window) const;

 private:
  struct Entry {
    explicit Entry(const Task& task) : statistics(task) {}
    mutable std::mutex mutex;
    TaskStatistics statistics;
    Summary lateness;
  };

  std::vector<std::unique_ptr<Entry>> entries_;
};

}  // namespace stationd

// Statistics: what a task's histograms say, since start and for the last minute, for people and for the bus.
// Owned by whoever tells it (the daemon's housekeeping).
// One plain thread at a time (they allocate); the scan only ever writes its histograms.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "scan/figures.hpp"
#include "scan/histogram.hpp"
#include "scan/task.hpp"

namespace stationd {

/// Things of the last minute, in parts of 10 s.
template <class T> class MinuteRing {
 public:
  /// The part that now_ns belongs to; those that are over are emptied. Time that goes back stands still.
  T& at(std::int64_t now_ns) {
    const std::int64_t newest = now_ns / kPartNs;
    if (newest - newest_ >= static_cast<std::int64_t>(parts_.size()))
      parts_ = {};
    else
      for (std::int64_t i = newest_ + 1; i <= newest; ++i) part(i) = T{};
    if (newest > newest_) newest_ = newest;
    return part(newest_);
  }
  const auto& parts() const noexcept { return parts_; }

 private:
  static constexpr std::int64_t kPartNs = 10'000'000'000;
  T& part(std::int64_t number) { return parts_[static_cast<std::size_t>(number) % parts_.size()]; }

  std::array<T, 7> parts_{};
  std::int64_t newest_ = 0;
};

/// A counter that only grows, and by how much it did in the last minute.
class CounterReader {
 public:
  void collect(std::uint64_t value, std::int64_t now_ns);
  std::uint64_t value(Window window) const noexcept;

 private:
  std::uint64_t value_ = 0;
  MinuteRing<std::uint64_t> minute_;
};

class HistogramReader {
 public:
  explicit HistogramReader(const Histogram& source) : source_(&source) {}

  /// Takes over what was recorded since the last call; at least once in a part of the minute, or what is
  /// older passes for new. `now_ns`: CLOCK_MONOTONIC, or any time that does not go back.
  void collect(std::int64_t now_ns);
  /// The same with a reading that was made before.
  void take(const Histogram::Reading& now, std::int64_t now_ns);
  Summary summary(Window window) const;
  /// The buckets that hold anything, in order.
  std::vector<BucketCount> buckets(Window window) const;

 private:
  struct Some {  // most buckets of ten seconds are empty
    std::uint16_t bucket;
    std::uint32_t count;
  };
  struct Part {
    std::vector<Some> some;  // ascending
    std::uint64_t sum_ns = 0;
    void add(std::size_t bucket, std::uint32_t count);
  };

  void cover(std::size_t first, std::size_t last);

  const Histogram* source_;
  std::size_t first_ = 0;              // bucket of totals_[0]
  std::vector<std::uint64_t> totals_;  // no more of them than hold anything, with what lies between
  std::uint64_t sum_ns_ = 0;
  std::int64_t min_ns_ = 0, max_ns_ = 0;
  MinuteRing<Part> minute_;
};

/// All figures of a task and its stations.
class TaskStatistics {
 public:
  /// `task` must outlive it.
  explicit TaskStatistics(const Task& task);

  const Task& task() const noexcept { return task_; }
  void collect(std::int64_t now_ns);
  /// `place`: of the station in the task.
  const HistogramReader& figure(std::size_t place, Figure figure) const;
  std::uint64_t scans(Window window) const noexcept { return scans_.value(window); }
  std::uint64_t deadline_misses(Window window) const noexcept { return misses_.value(window); }
  std::uint64_t skipped(Window window) const noexcept { return skipped_.value(window); }

 private:
  const Task& task_;
  CounterReader scans_, misses_, skipped_;
  std::vector<HistogramReader> readers_;  // lateness, execution, response, phases, then two for each station
};

}  // namespace stationd

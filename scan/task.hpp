// Task: runs the scans of its stations, phase by phase, and keeps exact counts of what was late.
// Owned by the composer; driven by its real-time thread, or by a test with any numbers it likes.
// Set-up by one thread; run() in the scan thread alone; figures() and records() from others as noted.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "scan/histogram.hpp"
#include "scan/nonblocking.hpp"
#include "scan/ring.hpp"
#include "scan/schedule.hpp"
#include "scan/station.hpp"

namespace stationd {

struct TaskOptions {
  std::string name;
  std::int64_t period_ns = 10'000'000;  ///< 250 us to 60 s
  std::int64_t phase_ns = 0;
  OverrunPolicy overrun = OverrunPolicy::skip;
};

/// Stamps phases. The clock behind it is invisible to programs; a test injects its own.
class Stopwatch {
 public:
  virtual ~Stopwatch() = default;
  virtual std::int64_t now_ns() noexcept STATIOND_NONBLOCKING = 0;
};

/// Wakes the thread that sends what a cycle has published. Without one nobody is woken.
class Waker {
 public:
  virtual ~Waker() = default;
  /// Scan thread; neither blocks nor fails: a wake that is not seen yet stands for the later ones, too.
  virtual void wake() noexcept STATIOND_NONBLOCKING = 0;
};

/// One cycle by phase, in nanoseconds; crosses to the log thread when the cycle missed its deadline.
struct CycleRecord {
  std::uint64_t scan = 0;
  std::int64_t lateness_ns = 0;
  std::int64_t latch_ns = 0, execute_ns = 0, commit_ns = 0, publish_ns = 0, service_ns = 0;
  std::int64_t response_ns = 0;  ///< due time to outputs committed
  std::uint64_t skipped = 0;     ///< cycles of the grid that did not run after this one
  bool committed_late = false;   ///< outputs committed after the next due time
};

/// Counters and histograms of a task; any thread may read.
struct TaskFigures {
  std::atomic<std::uint64_t> scans{0};
  std::atomic<std::uint64_t> deadline_misses{0};  ///< scans committed late plus skipped cycles
  std::atomic<std::uint64_t> skipped{0};
  Histogram lateness, execution, response;
};

class Task {
 public:
  /// Stations run in the given order. The references must outlive the task.
  Task(TaskOptions options, std::vector<Station*> stations, Stopwatch& stopwatch);

  /// Set-up. Called once a cycle, right after publish: no request holds up an event or a PV; and a second
  /// time in a cycle that serviced requests, so that their replies need not wait for the next one. Null:
  /// nobody. Must outlive the task's runs.
  void set_waker(Waker* waker) noexcept { waker_ = waker; }

  /// Runs cycle k of the schedule, woken at woken_ns. Returns the number of the cycle to run next.
  /// `utc_offset_ns`:
  /// CLOCK_REALTIME less CLOCK_MONOTONIC. Scans are numbered from 1.
  std::uint64_t run(const Schedule& schedule, std::uint64_t k, std::int64_t woken_ns,
                    std::int64_t utc_offset_ns) noexcept STATIOND_NONBLOCKING;

  const TaskOptions& options() const noexcept { return options_; }
  const std::vector<Station*>& stations() const noexcept { return stations_; }
  const TaskFigures& figures() const noexcept { return figures_; }
  /// Deadline misses, for one consumer thread. Full: the record is dropped, the counters stay exact.
  Ring<CycleRecord>& misses() noexcept { return misses_; }

 private:
  void wake() noexcept {
    if (waker_ != nullptr) waker_->wake();
  }
  std::uint64_t service(std::int64_t next_due_ns) noexcept STATIOND_NONBLOCKING;
  void account(CycleRecord& record) noexcept STATIOND_NONBLOCKING;

  static constexpr std::int64_t kServiceReserveNs = 20'000;  // left free before the next due time
  static constexpr int kServicePerScan = 32;  // and station: one flood does not eat the whole slack

  TaskOptions options_;
  std::vector<Station*> stations_;
  Stopwatch& stopwatch_;
  Waker* waker_ = nullptr;
  TaskFigures figures_;
  Ring<CycleRecord> misses_{64};
  std::uint64_t scan_ = 0;
};

}  // namespace stationd

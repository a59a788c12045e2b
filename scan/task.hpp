// Task: runs the scans of its stations, phase by phase, and keeps exact counts of what was late.
// Owned by the composer; driven by its real-time thread, or by a test with any numbers it likes.
// Set-up by one thread; run() in the scan thread alone; figures() and records() from others as noted.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
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

/// What a cycle consists of, in order.
enum class Phase : std::uint8_t { latch, execute, commit, publish, service };
inline constexpr std::size_t kPhases = 5;
std::string_view name_of(Phase phase) noexcept;

/// One cycle by phase, in nanoseconds; crosses to the log thread when the cycle missed its deadline.
struct CycleRecord {
  std::uint64_t scan = 0;
  std::int64_t lateness_ns = 0;
  std::int64_t latch_ns = 0, execute_ns = 0, commit_ns = 0, publish_ns = 0, service_ns = 0;
  std::int64_t response_ns = 0;  ///< due time to outputs committed
  std::uint64_t skipped = 0;     ///< cycles of the grid that did not run after this one
  bool committed_late = false;   ///< outputs committed after the next due time
  std::uint32_t slowest = 0;  ///< place in the task of the station whose latch, execute, commit took longest
  std::int64_t slowest_ns = 0;  ///< and how long
};

/// What the scans of one station take: its own share of latch, execute, commit; due time to its own commit.
struct StationFigures {
  Histogram execution, response;
};

/// Counters and histograms of a task; any thread may read. Execution is latch, execute and commit together.
struct TaskFigures {
  std::atomic<std::uint64_t> scans{0};
  std::atomic<std::uint64_t> deadline_misses{0};  ///< scans committed late plus skipped cycles
  std::atomic<std::uint64_t> skipped{0};
  Histogram lateness, execution, response;
  std::array<Histogram, kPhases> phases;
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
  /// Of the station at that place. The task's own where it is the only one: the same figures.
  const Histogram& execution_of(std::size_t place) const noexcept {
    return shares_.empty() ? figures_.execution : shares_[place].figures->execution;
  }
  const Histogram& response_of(std::size_t place) const noexcept {
    return shares_.empty() ? figures_.response : shares_[place].figures->response;
  }
  /// Deadline misses, for one consumer thread. Full: the record is dropped, the counters stay exact.
  Ring<CycleRecord>& misses() noexcept { return misses_; }

 private:
  void wake() noexcept {
    if (waker_ != nullptr) waker_->wake();
  }
  template <class Work> std::int64_t each(std::int64_t since_ns, Work work) noexcept STATIOND_NONBLOCKING;
  std::uint64_t service(std::int64_t next_due_ns) noexcept STATIOND_NONBLOCKING;
  void account_shares(CycleRecord& record, std::int64_t due_ns) noexcept STATIOND_NONBLOCKING;
  void account(const CycleRecord& record) noexcept STATIOND_NONBLOCKING;

  static constexpr std::int64_t kServiceReserveNs = 20'000;  // left free before the next due time
  static constexpr int kServicePerScan = 32;  // and station: one flood does not eat the whole slack

  TaskOptions options_;
  std::vector<Station*> stations_;
  Stopwatch& stopwatch_;
  Waker* waker_ = nullptr;
  TaskFigures figures_;
  struct Share {  // of one of several stations, in the cycle that runs
    std::int64_t spent_ns = 0;
    std::int64_t done_ns = 0;  // end of its latest phase
    std::unique_ptr<StationFigures> figures;
  };
  std::vector<Share> shares_;  // empty: there is one station
  Ring<CycleRecord> misses_{64};
  std::uint64_t scan_ = 0;
};

}  // namespace stationd

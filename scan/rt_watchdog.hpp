// RtWatchdog: a thread above all scans that takes the output permit of a station whose scan makes no
// progress, and demotes the stuck thread so that the rest of the machine lives (SCAN-9). Owned by the daemon.
// Watches threads that must outlive it. Set-up and stop() by a plain thread; the loop is the watchdog thread;
// reports(), stalled(), any_stuck() as noted.
#pragma once

#include <pthread.h>

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "scan/progress_watch.hpp"
#include "scan/ring.hpp"
#include "scan/rt_thread.hpp"

namespace stationd {

class RtWatchdog {
 public:
  /// SCHED_FIFO priority: above every scan's (1..95).
  static constexpr int kPriority = 96;

  struct Watched {
    Task* task;
    RtThread* thread;
    std::int64_t limit_ns;  ///< the task's `watchdog`
  };
  /// A task got stuck, or moves again; for log and service manager.
  struct Report {
    std::uint32_t task = 0;  ///< index of the watched
    bool stuck = false;
    std::int64_t idle_ns = 0;   ///< how long without progress
    std::int32_t station = -1;  ///< index of the station whose program was running; -1: none
    bool demoted = false;       ///< the thread had real-time rights and lost them
  };

  /// Set-up. It wakes ten times in the shortest limit, at least every 50 ms.
  explicit RtWatchdog(std::vector<Watched> watched);
  ~RtWatchdog();
  RtWatchdog(const RtWatchdog&) = delete;
  RtWatchdog& operator=(const RtWatchdog&) = delete;

  /// Starts the thread. Throws SetupError when it cannot be had; a refused priority is in the result.
  std::vector<RtGrant> start(const std::atomic<std::int64_t>& utc_offset_ns);
  /// Ends and joins the thread.
  void stop() noexcept;

  /// One consumer thread. Full: a report is dropped; any_stuck() stays right.
  Ring<Report>& reports() noexcept { return reports_; }
  /// Any thread. Whether the watchdog thread itself has not run for a second beyond its interval.
  bool stalled(std::int64_t now_ns) const noexcept;
  /// Any thread.
  bool any_stuck() const noexcept { return stuck_.load(std::memory_order_relaxed) != 0; }

 private:
  static void* entry(void* self);
  void loop() noexcept;
  void round(std::int64_t now_ns, std::int64_t elapsed_ns) noexcept;
  bool uses_cpu(std::size_t index) noexcept;
  bool judge(std::size_t index, std::int64_t now_ns, std::int64_t elapsed_ns) noexcept;
  void revoke(std::size_t index) noexcept;

  std::vector<Watched> watched_;
  std::int64_t round_ns_;
  struct Mark {
    std::int64_t owed_since_ns = 0;
    std::int64_t cpu_ns = 0;  // that the thread had used when the mark was seen first
  };
  std::vector<ProgressWatch> watches_;
  std::vector<Mark> marks_;
  std::vector<std::size_t> idle_;  // of one round: tasks that use no CPU
  Ring<Report> reports_{64};
  const std::atomic<std::int64_t>* utc_offset_ns_ = nullptr;
  std::atomic<std::int64_t> last_round_ns_{0};
  std::atomic<std::uint32_t> stuck_{0};
  std::atomic<bool> stop_{false};
  bool started_ = false;
  pthread_t thread_{};
};

}  // namespace stationd

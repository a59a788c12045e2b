// RtThread: the real-time thread that drives one task on its grid, and the rights it asks the kernel for.
// Owned by the daemon; the one place in scan/ that knows clocks and threads.
// Constructed and joined by a plain thread; the loop itself is the scan thread.
#pragma once

#include <pthread.h>
#include <time.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "scan/clock.hpp"
#include "scan/rt_rights.hpp"
#include "scan/task.hpp"

namespace stationd {

class MonotonicStopwatch final : public Stopwatch {
 public:
  std::int64_t now_ns() noexcept override { return monotonic_ns(); }
};

struct RtOptions {
  int priority = 0;          ///< SCHED_FIFO 1..95; 0: normal scheduling
  int cpu = -1;              ///< pinned to; -1: not
  std::int64_t spin_ns = 0;  ///< wake that much early and busy-wait to the due time
  int wake_fd = -1;          ///< non-blocking eventfd for the task's Waker; -1: none
};

/// One write to a non-blocking eventfd.
class EventfdWaker final : public Waker {
 public:
  explicit EventfdWaker(int descriptor) noexcept : descriptor_(descriptor) {}
  void wake() noexcept override;

 private:
  int descriptor_;
};

class RtThread {
 public:
  /// Becomes the task's waker where there is a wake_fd. `utc_offset_ns`: kept up to date by somebody else;
  /// read once a cycle.
  RtThread(Task& task, RtOptions options, const std::atomic<std::int64_t>& utc_offset_ns);
  ~RtThread();
  RtThread(const RtThread&) = delete;
  RtThread& operator=(const RtThread&) = delete;

  /// Starts the thread and asks for its rights; the first due time is the next multiple of the period, plus
  /// the phase.
  /// Throws SetupError when no thread can be had at all; refused rights are in the result.
  std::vector<RtGrant> start();
  /// Ends after the running cycle, at once if it waits. Joins. False: it did not end within `limit_ns` and
  /// was left alone.
  bool stop(std::int64_t limit_ns) noexcept;
  bool running() const noexcept { return started_; }
  /// The priority asked for; 0: none.
  int priority() const noexcept { return options_.priority; }

  /// Any thread. From when on the scan owes progress: the due time it waits for, or when it woke
  /// (CLOCK_MONOTONIC).
  std::int64_t owed_since_ns() const noexcept { return owed_since_ns_.load(std::memory_order_relaxed); }
  /// Any thread, between start() and stop(). CPU time that the scan thread has used.
  std::int64_t cpu_ns() const noexcept;
  /// The watchdog thread. Takes real-time rights from the scan thread (normal scheduling, nice 19) and gives
  /// them back. False: it had none, or the kernel refused.
  bool demote() noexcept;
  bool promote() noexcept;

 private:
  static void* entry(void* self);
  void loop() noexcept;
  void wait_until(std::int64_t due_ns) const noexcept;

  Task& task_;
  RtOptions options_;
  EventfdWaker waker_;
  const std::atomic<std::int64_t>& utc_offset_ns_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> ended_{false};
  std::atomic<std::int64_t> owed_since_ns_{INT64_MAX};
  std::atomic<pid_t> tid_{0};  // 0: the loop has not begun
  std::atomic<bool> fifo_{false};
  bool started_ = false;
  pthread_t thread_{};
  clockid_t cpu_clock_ = CLOCK_THREAD_CPUTIME_ID;
};

}  // namespace stationd

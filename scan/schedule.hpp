// Schedule: the fixed grid of a task's due times and the overrun arithmetic; plain numbers, no clock.
// Owned by the task's thread (or a test).
// Any one thread; never allocates.
#pragma once

#include <cstdint>

namespace stationd {

/// What to do when a scan still runs at its next due time, or was woken a whole period late.
enum class OverrunPolicy : std::uint8_t {
  skip,  ///< go on at the next due time of the original grid; the skipped cycles are counted
  fault  ///< besides, the task's stations go to FAULT
};

/// Due time k (0, 1, ...) is start + phase + k * period, exactly.
class Schedule {
 public:
  constexpr Schedule(std::int64_t start_ns, std::int64_t phase_ns, std::int64_t period_ns) noexcept
      : first_ns_(start_ns + phase_ns), period_ns_(period_ns) {}

  constexpr std::int64_t period_ns() const noexcept { return period_ns_; }
  constexpr std::int64_t due_ns(std::uint64_t k) const noexcept {
    return first_ns_ + static_cast<std::int64_t>(k) * period_ns_;
  }

  /// The cycle to run after cycle k, when the thread is done with it at now_ns: the next on the grid that is
  /// not past yet.
  constexpr std::uint64_t next(std::uint64_t k, std::int64_t now_ns) const noexcept {
    const std::int64_t late_ns = now_ns - due_ns(k + 1);
    if (late_ns <= 0) return k + 1;
    return k + 1 + static_cast<std::uint64_t>((late_ns + period_ns_ - 1) / period_ns_);
  }

 private:
  std::int64_t first_ns_;
  std::int64_t period_ns_;
};

}  // namespace stationd

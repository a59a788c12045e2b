// ProgressWatch: judges whether a scan makes progress (SCAN-9). Pure arithmetic; times are values.
// Owned by the watchdog, one for each task.
// The watchdog thread.
#pragma once

#include <algorithm>
#include <cstdint>

namespace stationd {

enum class Progress : std::uint8_t { fine, stuck, recovered };

class ProgressWatch {
 public:
  /// `limit_ns`: without progress for longer than this the task is stuck. `round_ns`: the watchdog's own
  /// interval.
  constexpr ProgressWatch(std::int64_t limit_ns, std::int64_t round_ns) noexcept
      : limit_ns_(limit_ns), round_ns_(round_ns) {}

  /// `owed_since_ns`: from when on the scan owes progress: the due time it waits for, or when it woke; every
  /// cycle changes it. `now_ns`, `elapsed_ns`: the time, and how much of it passed since the last call. At
  /// most two intervals of that are held against the scan: in the rest the watchdog did not run either, and
  /// the machine stood still. Each of stuck and recovered is said once.
  constexpr Progress judge(std::int64_t owed_since_ns, std::int64_t now_ns,
                           std::int64_t elapsed_ns) noexcept {
    const bool moved = owed_since_ns != seen_ns_;
    seen_ns_ = owed_since_ns;
    const std::int64_t more_ns =
        std::clamp<std::int64_t>(now_ns - owed_since_ns, 0, std::min(elapsed_ns, 2 * round_ns_));
    if (moved || more_ns == 0) {
      idle_ns_ = more_ns;
      if (!stuck_ || !moved) return Progress::fine;
      stuck_ = false;
      return Progress::recovered;
    }
    idle_ns_ += more_ns;
    if (stuck_ || idle_ns_ <= limit_ns_) return Progress::fine;
    stuck_ = true;
    return Progress::stuck;
  }

  /// What has passed so far is not held against the scan: another one had its CPU.
  constexpr void forgive() noexcept { idle_ns_ = 0; }

  constexpr bool stuck() const noexcept { return stuck_; }
  /// How long the scan has made no progress, as judged.
  constexpr std::int64_t idle_ns() const noexcept { return idle_ns_; }

 private:
  std::int64_t limit_ns_;
  std::int64_t round_ns_;
  std::int64_t seen_ns_ = 0;
  std::int64_t idle_ns_ = 0;
  bool stuck_ = false;
};

}  // namespace stationd

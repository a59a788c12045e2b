// The arithmetic of the watchdog: when a scan counts as stuck, and when it moves again.
#include <doctest/doctest.h>

#include "scan/progress_watch.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kLimit = 100 * kMs;
constexpr std::int64_t kRound = 10 * kMs;

/// Rounds until the watch says stuck, with a scan that owes progress since 0 and a watchdog that wakes every
/// `step_ns`.
int rounds_until_stuck(std::int64_t step_ns) {
  ProgressWatch watch(kLimit, kRound);
  std::int64_t now_ns = 0;
  watch.judge(1, now_ns, step_ns);
  for (int round = 1; round < 1000; ++round) {
    now_ns += step_ns;
    if (watch.judge(1, now_ns, step_ns) == Progress::stuck) return round;
  }
  return 0;
}

TEST_CASE("scan without progress is stuck in the first round beyond the limit, and said once [SCAN-9]") {
  CHECK(rounds_until_stuck(kRound) == 11);  // ten rounds are the limit itself
  ProgressWatch watch(kLimit, kRound);
  watch.judge(1, 0, kRound);
  int said = 0;
  for (int round = 1; round <= 50; ++round)
    said += watch.judge(1, round * kRound, kRound) == Progress::stuck ? 1 : 0;
  CHECK(said == 1);
  CHECK(watch.stuck());
}

TEST_CASE("scan that waits for a due time far ahead is not stuck [SCAN-9]") {
  ProgressWatch watch(kLimit, kRound);
  for (int round = 0; round < 6000; ++round)
    CHECK(watch.judge(60'000 * kMs, round * kRound, kRound) == Progress::fine);
  CHECK_FALSE(watch.stuck());
}

TEST_CASE("scan that is not woken at its due time is stuck as one that loops is [SCAN-9]") {
  ProgressWatch watch(kLimit, kRound);
  bool stuck = false;
  for (int round = 0; round < 40; ++round)
    stuck = watch.judge(200 * kMs, round * kRound, kRound) == Progress::stuck || stuck;
  CHECK(stuck);
}

TEST_CASE("machine that stood still for a minute makes no scan stuck [SCAN-9]") {
  ProgressWatch watch(kLimit, kRound);
  watch.judge(1, 10 * kMs, kRound);
  CHECK(watch.judge(1, 60'010 * kMs, 60'000 * kMs) == Progress::fine);
  CHECK(watch.judge(60'011 * kMs, 60'020 * kMs, kRound) == Progress::fine);
  CHECK_FALSE(watch.stuck());
}

TEST_CASE("scan that moves again is said to have recovered, once, and can be stuck again [SCAN-9]") {
  ProgressWatch watch(kLimit, kRound);
  std::int64_t now_ns = 0;
  for (int turn = 0; turn < 3; ++turn) {
    const std::int64_t owed_ns = now_ns;
    int stuck = 0;
    for (int round = 0; round < 20; ++round) {
      now_ns += kRound;
      stuck += watch.judge(owed_ns + 1, now_ns, kRound) == Progress::stuck ? 1 : 0;
    }
    CHECK(stuck == 1);
    now_ns += kRound;
    CHECK(watch.judge(now_ns - 1, now_ns, kRound) == Progress::recovered);
    CHECK(watch.judge(now_ns, now_ns + kRound, kRound) == Progress::fine);
    CHECK_FALSE(watch.stuck());
  }
}

TEST_CASE("scan that is slow in every cycle but below the limit is never stuck [SCAN-9]") {
  ProgressWatch watch(kLimit, kRound);
  for (int cycle = 0; cycle < 100; ++cycle) {
    const std::int64_t began_ns = cycle * 95 * kMs;
    for (int round = 1; round <= 9; ++round)
      CHECK(watch.judge(began_ns + 1, began_ns + round * kRound, kRound) == Progress::fine);
  }
}

}  // namespace
}  // namespace stationd

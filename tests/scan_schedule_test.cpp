// The grid of due times: exact for ever, and after whatever happens the next one on it.
#include <doctest/doctest.h>

#include <cstdint>
#include <random>

#include "scan/schedule.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kUs = 1'000;
constexpr std::int64_t kSecond = 1'000'000'000;

TEST_CASE("due time after 100,000 scans is exact to the nanosecond [SCAN-1]") {
  for (const std::int64_t period_ns : {250 * kUs, 333'333 * std::int64_t{1}, kSecond / 1000, 60 * kSecond}) {
    const Schedule schedule(123'456'789'012'345, 17, period_ns);
    std::int64_t summed_ns = 123'456'789'012'345 + 17;
    std::uint64_t k = 0;
    for (int i = 0; i < 100'000; ++i) {
      k = schedule.next(k, schedule.due_ns(k) + period_ns / 3);
      summed_ns += period_ns;
    }
    CHECK(k == 100'000);
    CHECK(schedule.due_ns(k) == summed_ns);
  }
}

TEST_CASE("first due time is start plus phase [SCAN-1]") {
  const Schedule schedule(1000, 30, 250);
  CHECK(schedule.due_ns(0) == 1030);
  CHECK(schedule.period_ns() == 250);
}

TEST_CASE("next cycle of a scan that ends in time is the one behind it [SCAN-3]") {
  const Schedule schedule(0, 0, 1000);
  CHECK(schedule.next(5, 5000) == 6);
  CHECK(schedule.next(5, 5999) == 6);
  CHECK(schedule.next(5, 4000) == 6);  // a clock that seems to stand still repeats nothing
}

TEST_CASE("next cycle of a scan that ends exactly at its next due time is that one [SCAN-3]") {
  CHECK(Schedule(0, 0, 1000).next(5, 6000) == 6);
}

TEST_CASE("next cycle of a scan that still runs at its next due time is the first not past [SCAN-3]") {
  const Schedule schedule(0, 0, 1000);
  CHECK(schedule.next(5, 6001) == 7);
  CHECK(schedule.next(5, 7000) == 7);
  CHECK(schedule.next(5, 7001) == 8);
  CHECK(schedule.next(0, 3600 * kSecond) == 3'600'000'000ULL);
}

TEST_CASE("next cycle after any delay is the least that is not past, by a search along the grid [SCAN-3]") {
  std::mt19937_64 random(7);
  const Schedule schedule(99, 12, 777);
  for (int i = 0; i < 20'000; ++i) {
    const std::uint64_t k = random() % 1000;
    const std::int64_t now_ns = schedule.due_ns(k) + static_cast<std::int64_t>(random() % 20'000);
    std::uint64_t least = k + 1;
    while (schedule.due_ns(least) < now_ns) ++least;
    REQUIRE(schedule.next(k, now_ns) == least);
  }
}

}  // namespace
}  // namespace stationd

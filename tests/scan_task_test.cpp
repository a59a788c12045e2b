// The task: phases, deadline misses, overrun policy, servicing within the slack.
#include <doctest/doctest.h>

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "scan/statistics.hpp"
#include "tests/scan_fixture.hpp"

namespace stationd {
namespace {

using test::FakeStopwatch;
using test::kMs;
using test::StationRig;
using enum StationState;

constexpr std::int64_t kPeriodNs = 10 * kMs;

TaskOptions options_of(OverrunPolicy policy) {
  TaskOptions options;
  options.name = "t";
  options.period_ns = kPeriodNs;
  options.overrun = policy;
  return options;
}

class CountingWaker final : public Waker {
 public:
  void wake() noexcept override {
    ++count;
    if (on_wake) on_wake();
  }
  int count = 0;
  std::function<void()> on_wake;
};

/// One station in one task, its time moved by the program's execution.
class TaskRig {
 public:
  explicit TaskRig(OverrunPolicy policy = OverrunPolicy::skip)
      : task(options_of(policy), {rig.station.get()}, stopwatch), schedule(0, 0, kPeriodNs) {
    rig.program->on_execute = [this](Cycle&) { stopwatch.time_ns += execute_ns; };
    rig.program->on_idle = rig.program->on_execute;
    task.set_waker(&waker);
  }
  /// Runs the next cycle on the grid, woken that late.
  void run(std::int64_t late_ns = 0) {
    const std::int64_t woken_ns = schedule.due_ns(k) + late_ns;
    stopwatch.time_ns = woken_ns;
    k = task.run(schedule, k, woken_ns, 0);
  }
  CycleRecord miss() {
    CycleRecord record;
    task.misses().pop(record);
    return record;
  }
  std::uint64_t misses() const { return task.figures().deadline_misses.load(); }
  std::uint64_t skipped() const { return task.figures().skipped.load(); }

  StationRig rig;
  FakeStopwatch stopwatch;
  CountingWaker waker;
  Task task;
  Schedule schedule;
  std::uint64_t k = 1;
  std::int64_t execute_ns = 0;
};

TEST_CASE("cycle in time is no deadline miss however late it woke [SCAN-4]") {
  TaskRig t;
  t.execute_ns = kMs;
  t.run();
  t.run(8 * kMs);
  t.run(9 * kMs);  // committed exactly at the next due time
  CHECK(t.task.figures().scans.load() == 3);
  CHECK(t.misses() == 0);
  CHECK(t.skipped() == 0);
  CHECK(t.k == 4);
  CHECK(t.task.figures().lateness.max_ns() == 9 * kMs);
  CHECK(t.task.figures().response.max_ns() == 10 * kMs);
  CHECK(t.task.figures().execution.max_ns() == kMs);
}

TEST_CASE(
    "cycle committed one nanosecond after its next due time is a miss, and so is the skipped one [SCAN-4]") {
  TaskRig t;
  t.execute_ns = kPeriodNs + 1;
  t.run();
  CHECK(t.misses() == 2);
  CHECK(t.skipped() == 1);
  CHECK(t.k == 3);
  const CycleRecord record = t.miss();
  CHECK(record.scan == 1);
  CHECK(record.committed_late);
  CHECK(record.skipped == 1);
  CHECK(record.execute_ns == kPeriodNs + 1);
}

TEST_CASE(
    "cycle that commits in time and ends after its next due time misses the skipped one alone [SCAN-4]") {
  TaskRig t;
  t.waker.on_wake = [&t] { t.stopwatch.time_ns += kPeriodNs + 1; };  // behind the commit
  t.run();
  CHECK(t.misses() == 1);
  CHECK(t.skipped() == 1);
  CHECK_FALSE(t.miss().committed_late);
}

TEST_CASE("cycle woken whole periods late runs once, then the grid goes on: no burst [SCAN-3]") {
  TaskRig t;
  t.execute_ns = kMs;
  t.run(5 * kPeriodNs + 3 * kMs);  // cycle 1, in the time of cycle 6
  CHECK(t.k == 7);
  CHECK(t.misses() == 6);  // itself and 2..6
  CHECK(t.skipped() == 5);
  CHECK(t.miss().lateness_ns == 5 * kPeriodNs + 3 * kMs);
  t.run();
  CHECK(t.misses() == 6);
  CHECK(t.task.figures().lateness.count() == 2);
}

TEST_CASE("phases of a cycle are stamped one after the other and add up [SCAN-2, SCAN-6]") {
  TaskRig t;
  t.stopwatch.step_ns = 7;
  t.execute_ns = 20 * kMs;
  t.run(100);
  const CycleRecord record = t.miss();
  CHECK(record.lateness_ns == 100);
  CHECK(record.latch_ns == 7);
  CHECK(record.execute_ns == 20 * kMs + 7);
  CHECK(record.commit_ns == 7);
  CHECK(record.publish_ns == 7);
  CHECK(record.service_ns == 14);  // a look at the slack, and the stamp
  CHECK(record.response_ns == 100 + 20 * kMs + 21);
}

TEST_CASE("figures of a cycle of 1.5 s are right [SCAN-6]") {
  TaskRig t;
  t.execute_ns = 4 * kMs;
  for (int i = 0; i < 99; ++i) t.run(kMs);
  t.execute_ns = 1'500 * kMs;
  t.run(kMs);
  TaskStatistics statistics(t.task);
  statistics.collect(0);
  const auto told = [&](Figure figure) { return statistics.figure(0, figure).summary(Window::since_start); };
  for (const Figure figure : {Figure::execution, Figure::task_execution, Figure::execute}) {
    CAPTURE(name_of(figure));
    CHECK(told(figure).count == 100);
    CHECK(told(figure).min_ns == 4 * kMs);
    CHECK(told(figure).max_ns == 1'500 * kMs);
    CHECK(told(figure).mean_ns == (99 * 4 * kMs + 1'500 * kMs) / 100);
    CHECK(told(figure).p50_ns == doctest::Approx(4 * kMs).epsilon(0.01));
    CHECK(told(figure).p99_ns == doctest::Approx(4 * kMs).epsilon(0.01));
    CHECK(told(figure).p999_ns == doctest::Approx(1'500 * kMs).epsilon(0.01));
  }
  CHECK(told(Figure::lateness).p999_ns == kMs);
  CHECK(told(Figure::response).max_ns == 1'501 * kMs);
  CHECK(told(Figure::task_response).max_ns == 1'501 * kMs);
  CHECK(told(Figure::commit).max_ns == 0);
  CHECK(statistics.scans(Window::last_minute) == 100);
  CHECK(statistics.deadline_misses(Window::since_start) == 151);
  CHECK(statistics.skipped(Window::last_minute) == 150);
  CHECK(t.k == 100 + 151);
}

TEST_CASE("each phase of a cycle has its own figure [SCAN-6]") {
  TaskRig t;
  t.stopwatch.step_ns = 7;
  t.execute_ns = 2 * kMs;
  t.waker.on_wake = [&t] { t.stopwatch.time_ns += 100; };  // behind publish, so of service
  for (int i = 0; i < 10; ++i) t.run(50);
  TaskStatistics statistics(t.task);
  statistics.collect(0);
  const auto max_ns = [&](Figure figure) {
    CHECK(statistics.figure(0, figure).summary(Window::last_minute).count == 10);
    return statistics.figure(0, figure).summary(Window::since_start).max_ns;
  };
  CHECK(max_ns(Figure::lateness) == 50);
  CHECK(max_ns(Figure::latch) == 7);
  CHECK(max_ns(Figure::execute) == 2 * kMs + 7);
  CHECK(max_ns(Figure::commit) == 7);
  CHECK(max_ns(Figure::publish) == 7);
  CHECK(max_ns(Figure::service) == 100 + 14);
  CHECK(max_ns(Figure::execution) == 2 * kMs + 21);
  CHECK(max_ns(Figure::response) == 2 * kMs + 71);
}

TEST_CASE("figures of several stations are each one's own, those of the task their sum [SCAN-6, SCAN-7]") {
  StationRig a(StationRig::named("A"));
  StationRig b(StationRig::named("B"));
  FakeStopwatch stopwatch;
  a.program->on_idle = [&](Cycle&) { stopwatch.time_ns += 2 * kMs; };
  b.program->on_idle = [&](Cycle&) { stopwatch.time_ns += 9 * kMs; };
  Task task(options_of(OverrunPolicy::skip), {a.station.get(), b.station.get()}, stopwatch);
  stopwatch.time_ns = kPeriodNs + kMs;
  stopwatch.step_ns = 10;
  task.run(Schedule(0, 0, kPeriodNs), 1, kPeriodNs + kMs, 0);
  TaskStatistics statistics(task);
  statistics.collect(0);
  const auto max_ns = [&](std::size_t place, Figure figure) {
    return statistics.figure(place, figure).summary(Window::since_start).max_ns;
  };
  CHECK(max_ns(0, Figure::execution) == 2 * kMs + 30);
  CHECK(max_ns(1, Figure::execution) == 9 * kMs + 30);
  CHECK(max_ns(0, Figure::task_execution) == 11 * kMs + 60);
  CHECK(max_ns(0, Figure::response) == 12 * kMs + 50);
  CHECK(max_ns(1, Figure::response) == 12 * kMs + 60);
  CHECK(max_ns(1, Figure::task_response) == 12 * kMs + 60);
  CHECK(max_ns(0, Figure::lateness) == kMs);
  CHECK(max_ns(1, Figure::execute) == 11 * kMs + 20);
  CycleRecord record;
  REQUIRE(task.misses().pop(record));
  CHECK(record.slowest == 1);
  CHECK(record.slowest_ns == 9 * kMs + 30);
}

TEST_CASE(
    "overrun policy fault sends each station of the task to FAULT and makes its outputs safe [SCAN-3]") {
  TaskRig t(OverrunPolicy::fault);
  t.rig.push(Verb::start);
  t.run();
  t.run();
  CHECK(t.rig.station->state() == RUNNING);
  t.execute_ns = 11 * kMs;
  t.run();
  CHECK(t.rig.station->state() == FAULT);
  CHECK(t.rig.station->active_fault() == code::overrun);
  CHECK_FALSE(t.rig.permit());
  t.execute_ns = 0;
  t.run();
  CHECK(t.rig.driven_outputs()[1] == 3);
  CHECK(t.rig.events().size() == 1);
}

TEST_CASE("overrun policy skip leaves the station running [SCAN-3]") {
  TaskRig t(OverrunPolicy::skip);
  t.rig.push(Verb::start);
  t.run();
  t.execute_ns = 25 * kMs;
  t.run();
  CHECK(t.rig.station->state() == RUNNING);
}

TEST_CASE("misses beyond the ring of records are still counted [SCAN-4]") {
  TaskRig t;
  t.execute_ns = 11 * kMs;
  for (int i = 0; i < 200; ++i) t.run();
  CHECK(t.misses() == 400);
  CHECK(t.task.misses().dropped() == 200 - t.task.misses().capacity());
}

TEST_CASE("status tells the misses of the task up to the scan before [SCAN-4]") {
  TaskRig t;
  t.execute_ns = 11 * kMs;
  t.run();
  t.run();
  CHECK(t.rig.status().deadline_misses == 2);
}

TEST_CASE("requests are serviced in bounded number per scan [REQ-2]") {
  TaskRig t;
  for (std::uint64_t token = 1; token <= 50; ++token) t.rig.push(Verb::reset, token);
  t.run();
  Reply reply;
  int served = 0;
  while (t.rig.station->port().replies.pop(reply)) ++served;
  CHECK(served == 32);
  t.run();
  while (t.rig.station->port().replies.pop(reply)) ++served;
  CHECK(served == 50);
}

TEST_CASE("requests are serviced within the slack only, and the rest in the next scan [REQ-2]") {
  TaskRig t;
  t.stopwatch.step_ns = 10'000;  // each look costs 10 us
  t.execute_ns = 9'800'000;
  for (std::uint64_t token = 1; token <= 32; ++token) t.rig.push(Verb::reset, token);
  t.run();
  int served = 0;
  Reply reply;
  while (t.rig.station->port().replies.pop(reply)) ++served;
  CHECK(served == 13);  // the look behind the 13th finds less than the reserve of 20 us
  CHECK(t.misses() == 0);
  CHECK(t.k == 2);
}

TEST_CASE("flood of requests raises no deadline miss [REQ-2]") {
  TaskRig t;
  t.stopwatch.step_ns = 10'000;
  t.execute_ns = 9 * kMs;
  for (int i = 0; i < 1'000; ++i) {
    for (int n = 0; n < 40; ++n) t.rig.push(Verb::reset, 0);
    t.run();
  }
  CHECK(t.misses() == 0);
}

TEST_CASE("permanent overrun services no request and never starves Stop [REQ-2]") {
  TaskRig t;
  t.rig.push(Verb::start);
  t.run();
  t.rig.reply();
  t.execute_ns = 15 * kMs;
  for (int i = 0; i < 100; ++i) {
    t.rig.push(Verb::get);
    t.run();
  }
  CHECK(t.rig.reply().outcome == Outcome::refused);  // none came
  t.rig.stop(StopMode::immediate);
  t.run();
  CHECK(t.rig.station->state() == STOPPED);
  CHECK_FALSE(t.rig.permit());
  CHECK(t.rig.driven_outputs() == std::vector<Slot>{0, 3, 0});
}

TEST_CASE("waker is called once a cycle, after publish and before requests are serviced [SCAN-5]") {
  TaskRig t;
  t.run();
  CHECK(t.waker.count == 1);
  std::vector<StationState> states;
  t.waker.on_wake = [&] {
    StatusRecord status;
    CHECK((t.rig.station->port().status.take(status) || !states.empty()));
    states.push_back(t.rig.station->state());
  };
  t.rig.push(Verb::start);
  t.run();
  CHECK(states == std::vector<StationState>{STOPPED, RUNNING});  // once more for the reply
  t.run();
  CHECK(t.waker.count == 4);
}

TEST_CASE("wall clock that is set back and forth changes only the time stamps for people [SCAN-1, SCAN-4]") {
  constexpr std::int64_t kHourNs = 3'600'000'000'000;
  TaskRig steady;
  TaskRig stepped;
  std::mt19937_64 random(7);
  for (int cycle = 0; cycle < 1000; ++cycle) {
    const std::int64_t late_ns = cycle % 97 == 0 ? 25 * kMs : cycle % 3 * 1'000;
    const std::int64_t offset_ns = static_cast<std::int64_t>(random() % 2'000) * kHourNs;
    for (TaskRig* t : {&steady, &stepped}) {
      StationRig::feed(*t->rig.inputs, {1, 2}, t->schedule.due_ns(t->k));
      t->stopwatch.time_ns = t->schedule.due_ns(t->k) + late_ns;
      t->k = t->task.run(t->schedule, t->k, t->stopwatch.time_ns, t == &stepped ? offset_ns : 0);
    }
    REQUIRE(stepped.k == steady.k);
    REQUIRE(stepped.rig.status().utc_ns - offset_ns == steady.rig.status().utc_ns);
    REQUIRE(stepped.rig.program->part.quality() == steady.rig.program->part.quality());
  }
  CHECK(steady.misses() > 0);
  CHECK(stepped.misses() == steady.misses());
  CHECK(stepped.skipped() == steady.skipped());
  CHECK(stepped.task.figures().lateness.max_ns() == steady.task.figures().lateness.max_ns());
}

TEST_CASE("task without a waker wakes nobody") {
  TaskRig t;
  t.task.set_waker(nullptr);
  t.run();
  CHECK(t.waker.count == 0);
}

TEST_CASE("stations of a task run in the written order, phase by phase, in one time [SCAN-2, SCAN-7]") {
  StationRig a(StationRig::named("A"));
  StationRig b(StationRig::named("B"));
  FakeStopwatch stopwatch;
  stopwatch.step_ns = 5;
  Task task(options_of(OverrunPolicy::skip), {a.station.get(), b.station.get()}, stopwatch);
  std::string order;
  a.program->on_idle = [&](Cycle& cycle) {
    order += "a" + std::to_string(cycle.now_ns()) + " ";
    a.program->code = 55;
  };
  b.program->on_idle = [&](Cycle& cycle) {
    order += "b" + std::to_string(cycle.now_ns());
    CHECK_FALSE(a.station->pvs()[0]->blocks.update());  // nothing is published before all have executed
  };
  task.run(Schedule(0, 0, kPeriodNs), 1, kPeriodNs + 3, 0);
  CHECK(order == "a10000003 b10000003");
  CHECK(a.status().scan == 1);
}

/// What the architecture page says about the grid, in the plainest words, cycle by cycle.
struct PlainGrid {
  std::uint64_t scans = 0, misses = 0, skipped = 0, bursts = 0;
  std::int64_t due_ns = 0, last_due_ns = -1;

  void run(std::int64_t woken_ns, std::int64_t committed_ns, std::int64_t ended_ns, std::int64_t period_ns) {
    ++scans;
    bursts += due_ns <= last_due_ns;
    last_due_ns = due_ns;
    misses += committed_ns > due_ns + period_ns;
    static_cast<void>(woken_ns);
    due_ns += period_ns;
    while (due_ns < ended_ns) {
      ++skipped;
      ++misses;
      due_ns += period_ns;
    }
  }
};

TEST_CASE(
    "a million cycles with random late wake-ups and overruns keep to the plain grid [SCAN-1, SCAN-3, "
    "SCAN-4]") {
  std::mt19937_64 random(2024);
  const auto often = [&](unsigned percent) { return random() % 100 < percent; };
  const auto below = [&](std::int64_t ns) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(ns));
  };
  TaskRig t;
  PlainGrid plain;
  plain.due_ns = t.schedule.due_ns(t.k);
  std::int64_t committed_ns = 0;
  std::int64_t behind_ns = 0;
  t.waker.on_wake = [&] {
    committed_ns = t.stopwatch.time_ns;
    t.stopwatch.time_ns += behind_ns;
  };
  std::uint64_t off_grid = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    off_grid += t.schedule.due_ns(t.k) != plain.due_ns;
    const std::int64_t late_ns = often(2) ? below(5 * kPeriodNs) : below(kMs);
    t.execute_ns = often(2) ? below(4 * kPeriodNs) : below(6 * kMs);
    behind_ns = often(1) ? below(2 * kPeriodNs) : 0;
    const std::int64_t woken_ns = plain.due_ns + late_ns;
    t.run(late_ns);
    plain.run(woken_ns, committed_ns, t.stopwatch.time_ns, kPeriodNs);
  }
  CHECK(off_grid == 0);
  CHECK(plain.bursts == 0);
  CHECK(t.task.figures().scans.load() == plain.scans);
  CHECK(t.misses() == plain.misses);
  CHECK(t.skipped() == plain.skipped);
  CHECK(plain.skipped > 10'000);
  CHECK(t.k == plain.scans + plain.skipped + 1);
}

}  // namespace
}  // namespace stationd

// The watchdog thread over real scan threads: loops on every CPU, at every priority, and what becomes of
// them.
#include <doctest/doctest.h>
#include <sched.h>
#include <sys/sysinfo.h>
#include <time.h>

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "scan/clock.hpp"
#include "scan/rt_watchdog.hpp"
#include "tests/scan_fixture.hpp"

namespace stationd {
namespace {

using test::StationRig;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kLimit = 30 * kMs;
constexpr std::int64_t kEndLimit = 20'000 * kMs;

/// A station whose program loops from its fifth scan on until it is let go.
class Looping {
 public:
  Looping(int cpu, int priority, const std::atomic<bool>& held)
      : task(options(), {rig.station.get()}, stopwatch), thread(task, {priority, cpu, 0, -1}, offset) {
    const auto body = [this, &held](Cycle& cycle) {
      if (cycle.scan() < 5) return;
      while (held.load(std::memory_order_relaxed)) policy.store(sched_getscheduler(0));
    };
    rig.program->on_execute = body;
    rig.program->on_idle = body;
  }
  static TaskOptions options() {
    TaskOptions made;
    made.name = "loop";
    made.period_ns = 2 * kMs;
    return made;
  }

  StationRig rig;
  MonotonicStopwatch stopwatch;
  std::atomic<std::int64_t> offset{0};
  std::atomic<int> policy{-1};  // as the loop itself sees it
  Task task;
  RtThread thread;
};

/// Waits for a condition, with the patience of a busy machine; this thread has normal scheduling.
template <class Condition> bool in_time(Condition condition) {
  const std::int64_t until_ns = monotonic_ns() + kEndLimit;
  while (!condition()) {
    if (monotonic_ns() > until_ns) return false;
    const timespec pause{0, kMs};
    nanosleep(&pause, nullptr);
  }
  return true;
}

/// One looping task on each CPU under a watchdog.
class Machine {
 public:
  /// With `bystander`, a task of lowest priority that does nothing wrong.
  explicit Machine(int priority, bool bystander = false) {
    std::vector<RtWatchdog::Watched> watched;
    for (int cpu = 0; cpu < get_nprocs(); ++cpu)
      loops.push_back(std::make_unique<Looping>(cpu, priority, held));
    if (bystander) loops.insert(loops.begin(), std::make_unique<Looping>(-1, 1, never));
    // A machine that is busy with other things keeps the bystander waiting, too: a longer limit for that.
    for (auto& loop : loops) watched.push_back({&loop->task, &loop->thread, bystander ? 5 * kLimit : kLimit});
    watchdog = std::make_unique<RtWatchdog>(std::move(watched));
    for (RtGrant& g : watchdog->start(offset)) grants.push_back(std::move(g));
    for (auto& loop : loops) {
      loop->rig.station->port().permit.store(true);
      for (RtGrant& g : loop->thread.start()) grants.push_back(std::move(g));
    }
  }
  ~Machine() {
    held.store(false);
    for (auto& loop : loops) loop->thread.stop(kEndLimit);
    watchdog->stop();
  }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  bool all(bool (*holds)(Looping&)) {
    for (auto& loop : loops)
      if (!holds(*loop)) return false;
    return true;
  }

  std::atomic<bool> held{true};
  const std::atomic<bool> never{false};
  std::atomic<std::int64_t> offset{0};
  std::vector<std::unique_ptr<Looping>> loops;
  std::unique_ptr<RtWatchdog> watchdog;
  std::vector<RtGrant> grants;
};

bool permit_gone(Looping& l) { return !l.rig.station->port().permit.load(); }
bool normal_now(Looping& l) { return l.policy.load() == SCHED_OTHER; }
bool moves(Looping& l) { return l.task.figures().scans.load() > 10; }

TEST_CASE("programs that loop on every CPU, at every priority, lose permit and rights [SCAN-9]") {
  for (int priority = 1; priority <= 95; ++priority) {
    CAPTURE(priority);
    Machine machine(priority);
    REQUIRE(in_time([&] { return machine.all(permit_gone); }));
    CHECK(in_time([&] { return machine.all(normal_now); }));
    CHECK(machine.watchdog->any_stuck());
    machine.held.store(false);
    CHECK(in_time([&] { return machine.all(moves); }));
    CHECK(in_time([&] { return !machine.watchdog->any_stuck(); }));
  }
}

TEST_CASE("scan that is kept waiting by loops on every CPU is not taken for stuck [SCAN-9]") {
  for (int turn = 0; turn < 20; ++turn) {
    Machine machine(20, true);
    Looping& bystander = *machine.loops.front();
    REQUIRE(in_time([&] { return permit_gone(*machine.loops.back()); }));
    const std::uint64_t scans = bystander.task.figures().scans.load();
    CHECK(in_time([&] { return bystander.task.figures().scans.load() > scans + 10; }));
    Event event;
    CHECK_FALSE(bystander.rig.station->port().runtime_events.pop(event));
    machine.held.store(false);
    CHECK(in_time([&] { return !machine.watchdog->any_stuck(); }));
  }
}

TEST_CASE(
    "watchdog reports who hangs, and that it moves again; the event is in the station's name [SCAN-9]") {
  Machine machine(10);
  REQUIRE(in_time([&] { return machine.all(permit_gone); }));
  RtWatchdog::Report report;
  REQUIRE(in_time([&] { return machine.watchdog->reports().pop(report); }));
  CHECK(report.stuck);
  CHECK(report.station == 0);
  CHECK(report.idle_ns > kLimit);
  StationPort& port = machine.loops[report.task]->rig.station->port();
  Event event;
  REQUIRE(port.runtime_events.pop(event));
  CHECK(event.code == code::watchdog);
  CHECK(event.active);
  CHECK(event.detail == report.idle_ns);
  machine.held.store(false);
  bool recovered = false;
  CHECK(in_time([&] {
    while (machine.watchdog->reports().pop(report)) recovered = recovered || !report.stuck;
    return recovered;
  }));
  CHECK(in_time([&] { return machine.all(moves); }));
  CHECK(machine.loops[0]->rig.station->active_fault() == code::watchdog);
}

TEST_CASE("watchdog says when it does not run itself [SCAN-9]") {
  Machine machine(0);
  CHECK_FALSE(machine.watchdog->stalled(monotonic_ns()));
  machine.watchdog->stop();
  CHECK(machine.watchdog->stalled(monotonic_ns() + 2'000 * kMs));
}

TEST_CASE("watchdog's priority is above every scan's [SCAN-9]") { CHECK(RtWatchdog::kPriority > 95); }

}  // namespace
}  // namespace stationd

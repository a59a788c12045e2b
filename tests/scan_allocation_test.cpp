// Counts allocations: whole cycles, fault paths and full rings included, make none.
#include <doctest/doctest.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include "tests/scan_fixture.hpp"

namespace {

std::atomic<std::uint64_t> allocations{0};

void* counted(std::size_t size, std::size_t alignment) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
  void* memory = std::aligned_alloc(alignment, whole == 0 ? alignment : whole);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) { return counted(size, alignof(std::max_align_t)); }
void* operator new[](std::size_t size) { return counted(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t a) {
  return counted(size, static_cast<std::size_t>(a));
}
void* operator new[](std::size_t size, std::align_val_t a) {
  return counted(size, static_cast<std::size_t>(a));
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

namespace stationd {
namespace {

using test::StationRig;

/// Faults, warnings, notes, saves, outputs, PVs: something of each in every scan.
void misbehave(test::HookProgram& program, Cycle& cycle) {
  const std::uint64_t n = cycle.scan();
  program.code = static_cast<std::uint32_t>(n);
  program.pieces = static_cast<std::uint32_t>(n);
  program.valve = n % 2 == 0;
  program.gripper = n % 3 == 0;
  cycle.report(static_cast<std::uint32_t>(n % 9), 1, true);
  for (std::uint32_t w = 1; w <= 20; ++w) cycle.warn(9000 + w, (n + w) % 4 == 0);
  cycle.note(9900);
  cycle.save_retained();
  if (n % 11 == 0) cycle.finished();
  if (n % 17 == 0) cycle.fault(9901);
}

/// Orders and field data of one scan; from the other threads' side.
void disturb(StationRig& rig, std::uint64_t n) {
  const auto request = [&](Verb verb) {
    Request r;
    r.token = n;
    r.order = ++rig.order;
    r.verb = verb;
    r.tag = static_cast<TagIndex>(n % rig.station->image().size());
    r.value = n % 2;
    rig.station->port().requests.push(r);
  };
  request(Verb::reset);
  request(Verb::start);
  for (int i = 0; i < 5; ++i) request(Verb::get);
  for (const Verb verb : {Verb::force, Verb::set, Verb::tags, Verb::unforce}) request(verb);
  if (n % 5 == 0) request(Verb::unforce_all);
  if (n % 7 == 0) rig.stop(n % 2 == 0 ? StopMode::immediate : StopMode::end_of_piece);
  if (n % 500 < 200) {
    const BlockView block{rig.inputs->blocks.writable(), rig.inputs->tags.layout};
    block.header() = {rig.now_ns, 0, 0, n, Quality::GOOD};
    rig.inputs->blocks.publish();
  }
}

TEST_CASE("10,000 cycles with faults, requests, events and full rings allocate nothing [SCAN-5]") {
  StationRig rig;
  for (TagIndex tag = 0; tag < rig.station->image().size(); ++tag)
    rig.station->image().spec(tag).writable = true;
  rig.program->on_execute = [&](Cycle& cycle) { misbehave(*rig.program, cycle); };
  rig.program->on_idle = rig.program->on_execute;
  test::FakeStopwatch stopwatch;
  stopwatch.step_ns = 2'000;
  TaskOptions options;
  options.period_ns = test::kPeriodNs;
  options.overrun = OverrunPolicy::fault;
  Task task(options, {rig.station.get()}, stopwatch);
  const Schedule schedule(0, 0, test::kPeriodNs);
  std::vector<std::uint64_t> states(4);
  std::uint64_t forced = 0;
  std::uint64_t k = task.run(schedule, 1, schedule.due_ns(1), 0);

  const std::uint64_t before = allocations.load();
  for (std::uint64_t n = 1; n <= 10'000; ++n) {
    rig.now_ns = schedule.due_ns(k) + static_cast<std::int64_t>(n % 97 == 0 ? 3 * test::kPeriodNs : 0);
    stopwatch.time_ns = rig.now_ns;
    disturb(rig, n);
    k = task.run(schedule, k, rig.now_ns, 0);
    ++states[static_cast<std::size_t>(rig.station->state())];
    forced += rig.status().forced;
    Reply reply;
    if (n % 50 == 0)
      while (rig.station->port().replies.pop(reply)) continue;
  }
  const std::uint64_t after = allocations.load();

  CHECK(after == before);
  CHECK(forced > 0);
  CHECK(states[static_cast<std::size_t>(StationState::STOPPED)] > 0);
  CHECK(states[static_cast<std::size_t>(StationState::RUNNING)] > 0);
  CHECK(states[static_cast<std::size_t>(StationState::FAULT)] > 0);
  CHECK(rig.station->port().events.dropped() > 0);
  CHECK(rig.station->port().requests.dropped() > 0);
  CHECK(task.misses().dropped() > 0);
}

TEST_CASE("counting allocator counts an allocation") {
  const std::uint64_t before = allocations.load();
  const auto memory = std::make_unique<std::vector<int>>(10);
  CHECK(memory->size() == 10);
  CHECK(allocations.load() >= before + 2);
}

}  // namespace
}  // namespace stationd

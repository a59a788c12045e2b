// What the tests of the engine share: a program made of hooks, a station around it, a stopwatch set by hand.
// Owned by each test case.
// The test's own thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scan/codes.hpp"
#include "scan/cycle.hpp"
#include "scan/program.hpp"
#include "scan/station.hpp"
#include "scan/task.hpp"

namespace stationd::test {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kPeriodNs = 10 * kMs;
constexpr std::int64_t kUtcOffsetNs = 1'700'000'000'000'000'000;

/// Does what its hooks say; has tags of each area, a PV of its own and one of another station.
class HookProgram final : public Program {
 public:
  HookProgram() {
    publish("Set", {{"CODE", &code}, {"SPEED", &speed}});
    subscribe("End", "UP", {{"CODE", &remote}});
  }
  void execute(Cycle& cycle) noexcept override {
    ++executed;
    if (on_execute) on_execute(cycle);
  }
  void idle(Cycle& cycle) noexcept override {
    ++idled;
    if (on_idle) on_idle(cycle);
  }
  std::uint32_t reset_obstacle(const Cycle&) noexcept override { return obstacle; }

  std::function<void(Cycle&)> on_execute, on_idle;
  std::uint32_t obstacle = 0;
  int executed = 0, idled = 0;

  In<bool> part{*this, "part", "Part present"};
  In<std::int32_t> position{*this, "position", "Arm position"};
  In<std::uint32_t> remote{*this, "remote.code", "Code that the upstream station announced"};
  Out<bool> valve{*this, "valve", "Valve"};
  Out<std::int32_t> speed{*this, "speed", "Belt speed"};
  Out<bool> gripper{*this, "gripper", "Gripper", true};
  Var<std::uint32_t> code{*this, "code", "Code announced", 7};
  Param<std::int32_t> limit{*this, "limit", "A parameter", 5, 0, 100};
  Retained<std::uint32_t> pieces{*this, "pieces", "Pieces made"};
};

class FakeStopwatch final : public Stopwatch {
 public:
  /// Each look advances the time by `step_ns`.
  std::int64_t now_ns() noexcept override {
    time_ns += step_ns;
    return time_ns;
  }
  std::int64_t time_ns = 0;
  std::int64_t step_ns = 0;
};

/// A sealed station with one device "dev", driven scan by scan.
class StationRig {
 public:
  explicit StationRig(StationOptions options = named("ST")) {
    auto made = std::make_unique<HookProgram>();
    program = made.get();
    station = std::make_unique<Station>(std::move(options), std::move(made));
    station->image().spec(*station->image().find("speed")).safe = to_slot<std::int32_t>(3);
    inputs = &station->add_device_inputs("dev", {"part", "position"}, 50 * kMs, 100 * kMs);
    outputs = &station->add_device_outputs("dev", {"valve", "speed", "gripper"});
    station->set_bus_limits(200 * kMs, 400 * kMs);
    station->seal();
  }
  static StationOptions named(std::string name) {
    StationOptions options;
    options.name = std::move(name);
    return options;
  }

  /// One scan, one period later; all that is requested is serviced.
  void scan() {
    scan_without_service();
    while (station->service_one()) {
    }
  }
  void scan_without_service() {
    now_ns += kPeriodNs;
    ++number;
    station->begin(now_ns, number, kUtcOffsetNs);
    station->latch();
    station->execute();
    station->commit();
    station->publish(0);
  }

  void push(Verb verb, std::uint64_t token = 1) {
    Request request;
    request.token = token;
    request.order = ++order;
    request.verb = verb;
    station->port().requests.push(request);
  }
  void stop(StopMode mode) { station->port().stop.set(mode, ++order); }
  Reply reply() const {
    Reply last;
    last.outcome = Outcome::refused;
    while (station->port().replies.pop(last)) {
    }
    return last;
  }
  std::vector<Event> events() const {
    std::vector<Event> all;
    Event event;
    while (station->port().events.pop(event)) all.push_back(event);
    return all;
  }
  StatusRecord status() const {
    StatusRecord record;
    station->port().status.take(record);
    return record;
  }
  bool permit() const { return station->port().permit.load(); }

  /// The device's (or topic's) thread publishes.
  static void feed(InputLink& link, const std::vector<Slot>& values, std::int64_t time_ns,
                   Quality quality = Quality::GOOD, Quality each = Quality::GOOD) {
    const BlockView block{link.blocks.writable(), link.tags.layout};
    std::copy(values.begin(), values.end(), block.slots().begin());
    std::fill(block.qualities().begin(), block.qualities().end(), each);
    block.header() = {time_ns, 0, 0, 1, quality};
    link.blocks.publish();
  }
  void feed_device(bool part, std::int32_t position, Quality quality = Quality::GOOD) const {
    feed(*inputs, {to_slot(part), to_slot(position)}, now_ns + kPeriodNs, quality);
  }

  /// What the device's thread reads: the newest block's slots.
  std::vector<Slot> driven_outputs() const {
    outputs->blocks.update();
    const ConstBlockView block{outputs->blocks.readable(), outputs->tags.layout};
    return {block.slots().begin(), block.slots().end()};
  }

  /// Into each state by orders alone.
  void go(StationState wanted) {
    if (wanted == StationState::STOPPED) return;
    push(Verb::start);
    scan();
    if (wanted == StationState::STOPPING) stop(StopMode::end_of_piece);
    if (wanted == StationState::FAULT) station->fault(code::overrun, 0);
    scan();
    reply();
    events();
    program->executed = program->idled = 0;
  }

  HookProgram* program = nullptr;
  std::unique_ptr<Station> station;
  InputLink* inputs = nullptr;
  OutputLink* outputs = nullptr;
  std::int64_t now_ns = 0;
  std::uint64_t number = 0;
  std::uint64_t order = 0;
};

}  // namespace stationd::test

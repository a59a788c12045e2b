// A station's links: quality of inputs, PVs, retained tags, set-up mistakes.
#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <vector>

#include "scan/error.hpp"
#include "tests/scan_fixture.hpp"

namespace stationd {
namespace {

using test::HookProgram;
using test::kMs;
using test::StationRig;
using enum StationState;

ConstBlockView newest(PvLink& link) {
  link.blocks.update();
  return {link.blocks.readable(), link.tags.layout};
}
ConstBlockView newest(RetainLink& link) {
  link.blocks.update();
  return {link.blocks.readable(), link.tags.layout};
}

/// Quality of `part` when its block is that old.
Quality quality_at_age(std::int64_t age_ns, Quality source = Quality::GOOD) {
  StationRig rig;
  StationRig::feed(*rig.inputs, {1, 0}, test::kPeriodNs - age_ns, source);
  rig.scan();
  return rig.program->part.quality();
}

TEST_CASE("inputs that were never seen are BAD with their initial values [IMG-2]") {
  StationRig rig;
  rig.scan();
  CHECK(rig.program->part.quality() == Quality::BAD);
  CHECK_FALSE(rig.program->part.get());
  CHECK(rig.program->remote.quality() == Quality::BAD);
}

TEST_CASE("inputs turn STALE, then BAD, by the age of their block, above each limit [IMG-2, PV-4]") {
  CHECK(quality_at_age(0) == Quality::GOOD);
  CHECK(quality_at_age(-5 * kMs) == Quality::GOOD);  // received after the scan woke
  CHECK(quality_at_age(50 * kMs) == Quality::GOOD);
  CHECK(quality_at_age(50 * kMs + 1) == Quality::STALE);
  CHECK(quality_at_age(100 * kMs) == Quality::STALE);
  CHECK(quality_at_age(100 * kMs + 1) == Quality::BAD);
}

TEST_CASE("quality that the source tells is not bettered by a young age [IMG-2]") {
  CHECK(quality_at_age(0, Quality::STALE) == Quality::STALE);
  CHECK(quality_at_age(60 * kMs, Quality::BAD) == Quality::BAD);
  CHECK(quality_at_age(101 * kMs, Quality::STALE) == Quality::BAD);
}

TEST_CASE("quality of a single tag is the worse of its own and its source's [IMG-2]") {
  StationRig rig;
  StationRig::feed(*rig.inputs, {1, 0}, test::kPeriodNs, Quality::GOOD, Quality::STALE);
  rig.scan();
  CHECK(rig.program->part.quality() == Quality::STALE);
}

TEST_CASE("inputs keep value and quality while no new block comes, then only the value [IMG-2]") {
  StationRig rig;
  rig.feed_device(true, 42);
  rig.scan();
  CHECK(rig.program->position == 42);
  rig.scan();
  CHECK(rig.program->position == 42);
  CHECK(rig.program->position.good());
  for (int i = 0; i < 20; ++i) rig.scan();
  CHECK(rig.program->position == 42);
  CHECK(rig.program->position.quality() == Quality::BAD);
}

TEST_CASE("block that its source calls BAD leaves the last values standing [IMG-2]") {
  StationRig rig;
  rig.feed_device(true, 42);
  rig.scan();
  rig.feed_device(false, -1, Quality::BAD);
  rig.scan();
  CHECK(rig.program->position == 42);
  CHECK(rig.program->position.quality() == Quality::BAD);
  rig.feed_device(false, 43);
  rig.scan();
  CHECK(rig.program->position == 43);
  CHECK(rig.program->position.good());
}

TEST_CASE("bus inputs have the limits of the bus, judged from local receipt [PV-4]") {
  StationRig rig;
  InputLink& link = *rig.station->bus_inputs()[0];
  CHECK(link.source == "End/UP");
  CHECK(link.members == std::vector<std::string>{"CODE"});
  StationRig::feed(link, {77}, test::kPeriodNs);
  rig.scan();
  CHECK(rig.program->remote == 77U);
  for (int i = 0; i < 20; ++i) rig.scan();
  CHECK(rig.program->remote.quality() == Quality::GOOD);
  rig.scan();
  CHECK(rig.program->remote.quality() == Quality::STALE);
  for (int i = 0; i < 20; ++i) rig.scan();
  CHECK(rig.program->remote.quality() == Quality::BAD);
}

TEST_CASE("outputs are committed in every scan with its number and time") {
  StationRig rig;
  for (int i = 0; i < 3; ++i) rig.scan();
  rig.outputs->blocks.update();
  const ConstBlockView block{rig.outputs->blocks.readable(), rig.outputs->tags.layout};
  CHECK(block.header().count == 3);
  CHECK(block.header().scan == 3);
  CHECK(block.header().time_ns == rig.now_ns);
  CHECK(block.header().quality == Quality::GOOD);
}

TEST_CASE("PV is published in the first scan, on change, and else at its heartbeat [PV-2]") {
  StationOptions options = StationRig::named("ST");
  options.pv_heartbeat_ns = 5 * test::kPeriodNs;
  StationRig rig(options);
  PvLink& pv = *rig.station->pvs()[0];
  CHECK(pv.topic == "Set");
  CHECK(pv.members == std::vector<std::string>{"CODE", "SPEED"});
  std::vector<std::uint64_t> published;
  for (int i = 1; i <= 14; ++i) {
    if (i == 3) rig.program->code = 8;
    rig.scan();
    if (pv.blocks.update()) published.push_back(rig.number);
  }
  CHECK(published == std::vector<std::uint64_t>{1, 3, 8, 13});
}

TEST_CASE("PV carries number and time of its scan, values in order and qualities [PV-3]") {
  StationRig rig;
  rig.scan();
  rig.program->code = 12;
  rig.scan();
  const ConstBlockView block = newest(*rig.station->pvs()[0]);
  CHECK(block.header().scan == 2);
  CHECK(block.header().time_ns == rig.now_ns);
  CHECK(block.header().utc_ns == rig.now_ns + test::kUtcOffsetNs);
  CHECK(block.slots()[0] == 12);
  CHECK(block.slots()[1] == 3);  // the safe value of `speed`
  CHECK(block.qualities()[0] == Quality::GOOD);
}

TEST_CASE("PVs that were overtaken before they were sent are counted, each one [PV-3]") {
  StationRig rig;
  PvLink& pv = *rig.station->pvs()[0];
  for (std::uint32_t i = 1; i <= 10; ++i) {
    rig.program->code = 100 + i;
    rig.scan();
  }
  CHECK(pv.overtaken.load() == 9);
  CHECK(newest(pv).slots()[0] == 110);
  CHECK(newest(pv).header().count == 10);
}

TEST_CASE("PV that only repeats an unsent one counts it as overtaken, too [PV-3]") {
  StationOptions options = StationRig::named("ST");
  options.pv_heartbeat_ns = test::kPeriodNs;
  StationRig rig(options);
  for (int i = 0; i < 3; ++i) rig.scan();
  CHECK(rig.station->pvs()[0]->overtaken.load() == 2);
}

TEST_CASE("retained tags are published when they change, with the scan that they are of [IMG-4]") {
  StationRig rig;
  RetainLink& retain = rig.station->retain();
  rig.scan();
  CHECK_FALSE(retain.blocks.update());  // all zero, as without a record
  rig.program->pieces = 5;
  rig.scan();
  CHECK(newest(retain).header().scan == 2);
  CHECK(newest(retain).slots()[0] == 5);
  rig.scan();
  CHECK_FALSE(retain.blocks.update());
  CHECK(retain.urgent_scan.load() == 0);
}

TEST_CASE(
    "retained tags asked to be saved are published at once, and the ticket tells when they are [IMG-5]") {
  StationRig rig;
  RetainLink& retain = rig.station->retain();
  std::uint64_t ticket = 0;
  bool saved = true;
  rig.program->on_idle = [&](Cycle& cycle) {
    if (ticket == 0) ticket = cycle.save_retained();
    saved = cycle.saved(ticket);
    rig.program->pieces = 6;  // as they are at the end of this scan
  };
  rig.scan();
  CHECK_FALSE(saved);
  CHECK(retain.urgent_scan.load() == 1);
  CHECK(newest(retain).slots()[0] == 6);
  CHECK(newest(retain).header().scan == ticket);
  rig.scan();
  CHECK_FALSE(saved);
  retain.saved_scan.store(1);
  rig.scan();
  CHECK(saved);
}

TEST_CASE("retained tags asked to be saved without a change are published all the same [IMG-5]") {
  StationRig rig;
  bool ask = false;
  rig.program->on_idle = [&](Cycle& cycle) {
    if (ask) cycle.save_retained();
  };
  rig.scan();
  ask = true;
  rig.scan();
  ask = false;
  CHECK(rig.station->retain().blocks.update());
  CHECK(rig.station->retain().urgent_scan.load() == 2);
  rig.scan();
  CHECK_FALSE(rig.station->retain().blocks.update());
}

TEST_CASE("restored station is warm with its values and stays STOPPED [IMG-4, IMG-5]") {
  StationRig rig;
  rig.station->restore(std::vector<Slot>{123, 1});
  Restart restart = Restart::cold;
  rig.program->on_idle = [&](Cycle& cycle) { restart = cycle.restart(); };
  rig.scan();
  CHECK(rig.station->state() == STOPPED);
  CHECK_FALSE(rig.permit());
  CHECK(rig.program->pieces == 123U);
  CHECK(restart == Restart::warm);
  const ConstBlockView block = newest(rig.station->retain());
  CHECK(block.header().count == 1);
  CHECK(block.slots()[0] == 123);
  CHECK(block.slots()[1] == 0);  // it does not run any more
}

TEST_CASE("restored station with resume goes on where it was running, and only there [IMG-5]") {
  StationOptions options = StationRig::named("ST");
  options.on_restart = OnRestart::resume;
  StationRig ran(options);
  bool started = false;
  ran.program->on_execute = [&](Cycle& cycle) { started |= cycle.started(); };
  ran.station->restore(std::vector<Slot>{1, 1});
  ran.feed_device(true, 0);
  ran.scan();
  CHECK(ran.station->state() == RUNNING);
  CHECK(ran.permit());
  CHECK(started);
  StationRig stood(options);
  stood.station->restore(std::vector<Slot>{1, 0});
  stood.feed_device(true, 0);
  stood.scan();
  CHECK(stood.station->state() == STOPPED);
}

TEST_CASE("restored station with resume waits until its devices have answered [IMG-5]") {
  StationOptions options = StationRig::named("ST");
  options.on_restart = OnRestart::resume;
  StationRig rig(options);
  rig.station->restore(std::vector<Slot>{1, 1});
  rig.scan();
  CHECK(rig.station->state() == STOPPED);
  rig.feed_device(true, 0);
  rig.scan();
  CHECK(rig.station->state() == RUNNING);
  StationRig stopped(options);
  stopped.station->restore(std::vector<Slot>{1, 1});
  stopped.stop(StopMode::immediate);
  stopped.scan();
  stopped.feed_device(true, 0);
  stopped.scan();
  CHECK(stopped.station->state() == STOPPED);
}

TEST_CASE("station whose permit was revoked from outside faults, safe until an operator acts [SCAN-9]") {
  StationRig rig;
  rig.go(RUNNING);
  rig.station->port().permit.store(false);
  rig.scan();
  CHECK(rig.station->state() == FAULT);
  CHECK(rig.station->active_fault() == code::watchdog);
  CHECK_FALSE(rig.permit());
}

TEST_CASE("retained record tells whether the station was running [IMG-5]") {
  StationRig rig;
  rig.go(RUNNING);
  rig.scan();
  CHECK(newest(rig.station->retain()).slots()[1] == 1);
  rig.station->fault(code::overrun, 0);
  rig.scan();
  CHECK(newest(rig.station->retain()).slots()[1] == 0);
}

TEST_CASE("restore of a record with another number of slots is refused [IMG-4]") {
  StationRig rig;
  CHECK_THROWS_WITH_AS(rig.station->restore(std::vector<Slot>{1}), doctest::Contains("1 slots, 2 expected"),
                       SetupError);
}

TEST_CASE("link to a tag that is unknown or of another area is refused by name") {
  Station station(StationRig::named("ST"), std::make_unique<HookProgram>());
  CHECK_THROWS_WITH_AS(station.add_device_inputs("dev", {"nope"}, 1, 2),
                       doctest::Contains("station ST has no tag \"nope\""), SetupError);
  CHECK_THROWS_WITH_AS(station.add_device_inputs("dev", {"valve"}, 1, 2),
                       doctest::Contains("ST.valve is of area output, not input"), SetupError);
  CHECK_THROWS_AS(station.add_device_outputs("dev", {"part"}), SetupError);
}

TEST_CASE("station that is sealed takes no more links") {
  StationRig rig;
  CHECK_THROWS_AS(rig.station->add_device_inputs("dev", {"part"}, 1, 2), SetupError);
  CHECK_THROWS_AS(rig.station->add_device_outputs("dev", {"valve"}), SetupError);
  CHECK_THROWS_AS(rig.station->set_bus_limits(1, 2), SetupError);
  CHECK_THROWS_AS(rig.station->seal(), SetupError);
}

class TakesTopicIntoOutput final : public Program {
 public:
  TakesTopicIntoOutput() { subscribe("End", "UP", {{"CODE", &lamp}}); }
  void execute(Cycle&) noexcept override {}
  Out<bool> lamp{*this, "lamp", "Lamp"};
};

TEST_CASE("program that takes a topic into an output is refused") {
  CHECK_THROWS_WITH_AS(Station(StationRig::named("ST"), std::make_unique<TakesTopicIntoOutput>()),
                       doctest::Contains("lamp"), SetupError);
}

TEST_CASE("epoch set after sealing is the one that status tells") {
  StationRig rig;
  rig.station->set_epoch(31);
  rig.scan();
  CHECK(rig.status().epoch == 31);
}

}  // namespace
}  // namespace stationd

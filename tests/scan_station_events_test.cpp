// Events of a station: warnings, devices lost and back, and the loss of events themselves.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "tests/scan_fixture.hpp"

namespace stationd {
namespace {

using test::kMs;
using test::StationRig;
using enum StationState;

StationOptions with_event_ring(std::size_t capacity) {
  StationOptions options = StationRig::named("ST");
  options.event_capacity = capacity;
  return options;
}

TEST_CASE("warning raises an event at each of its edges and none between [ASE-3]") {
  StationRig rig;
  bool active = true;
  rig.program->on_idle = [&](Cycle& cycle) { cycle.warn(2101, active, 5); };
  for (int i = 0; i < 3; ++i) rig.scan();
  CHECK(rig.status().warning == 2101);
  active = false;
  for (int i = 0; i < 3; ++i) rig.scan();
  CHECK(rig.status().warning == 0);
  active = true;
  rig.scan();
  const std::vector<Event> events = rig.events();
  REQUIRE(events.size() == 3);
  CHECK(events[0].active);
  CHECK(events[0].detail == 5);
  CHECK(events[0].scan == 1);
  CHECK_FALSE(events[1].active);
  CHECK(events[1].scan == 4);
  CHECK(events[2].active);
}

TEST_CASE("warnings beyond 16 wait until one of those has fallen [ASE-3]") {
  StationRig rig;
  std::uint32_t first = 1;
  rig.program->on_idle = [&](Cycle& cycle) {
    for (std::uint32_t n = 1; n <= 18; ++n) cycle.warn(9000 + n, n >= first);
  };
  rig.scan();
  CHECK(rig.events().size() == 16);
  first = 2;
  rig.scan();
  const std::vector<Event> events = rig.events();
  REQUIRE(events.size() == 2);
  CHECK(events[0].code == 9001);
  CHECK_FALSE(events[0].active);
  CHECK(events[1].code == 9017);
  CHECK(events[1].active);
}

TEST_CASE("warning with code 0 is none [ASE-3]") {
  StationRig rig;
  rig.program->on_idle = [](Cycle& cycle) {
    cycle.warn(0, true);
    cycle.warn(0, false);
  };
  rig.scan();
  CHECK(rig.events().empty());
}

TEST_CASE("warnings of execute fall when the station leaves RUNNING [ASE-3]") {
  StationRig rig;
  rig.program->on_execute = [](Cycle& cycle) { cycle.warn(2101, true); };
  rig.go(RUNNING);
  rig.scan();
  rig.events();
  rig.stop(StopMode::immediate);
  rig.scan();
  const std::vector<Event> events = rig.events();
  REQUIRE(events.size() == 1);
  CHECK_FALSE(events[0].active);
  CHECK(events[0].scan == rig.number);
}

TEST_CASE("warnings of idle do not flicker when a fault is reset [ASE-3]") {
  StationRig rig;
  rig.program->on_idle = [](Cycle& cycle) { cycle.warn(2101, true); };
  rig.go(FAULT);
  rig.scan();
  rig.events();
  rig.push(Verb::reset);
  rig.scan();
  rig.scan();
  const std::vector<Event> events = rig.events();
  REQUIRE(events.size() == 1);
  CHECK(events[0].code == code::overrun);
}

TEST_CASE("note raises one event with the severity of its code [ASE-3]") {
  StationRig rig;
  rig.program->on_idle = [](Cycle& cycle) { cycle.note(code::busy, 4); };
  rig.scan();
  const std::vector<Event> events = rig.events();
  REQUIRE(events.size() == 1);
  CHECK(events[0].severity == Severity::info);
  CHECK(events[0].edge);
}

TEST_CASE("device never seen raises no event, seen and lost one, back another [ASE-3]") {
  StationRig rig;
  for (int i = 0; i < 20; ++i) rig.scan();
  CHECK(rig.events().empty());
  rig.feed_device(true, 1);
  rig.scan();
  CHECK(rig.events().empty());
  while (rig.program->part.quality() != Quality::BAD) rig.scan();
  const std::uint64_t lost_scan = rig.number;
  for (int i = 0; i < 5; ++i) rig.scan();
  rig.feed_device(true, 1);
  rig.scan();
  const std::vector<Event> events = rig.events();
  REQUIRE(events.size() == 2);
  CHECK(events[0].code == code::device_lost);
  CHECK(events[0].active);
  CHECK(events[0].scan == lost_scan);
  CHECK(events[0].utc_ns == static_cast<std::int64_t>(lost_scan) * test::kPeriodNs + test::kUtcOffsetNs);
  CHECK_FALSE(events[1].active);
  CHECK(events[1].scan == rig.number);
}

TEST_CASE("remote station that its source gives up raises an event in that scan [PV-4]") {
  StationRig rig;
  InputLink& link = *rig.station->bus_inputs()[0];
  StationRig::feed(link, {5}, 10 * kMs);
  rig.scan();
  StationRig::feed(link, {5}, 10 * kMs, Quality::BAD);
  rig.scan();
  const std::vector<Event> events = rig.events();
  REQUIRE(events.size() == 1);
  CHECK(events[0].code == code::remote_lost);
  CHECK(events[0].detail == 0);
  CHECK(rig.program->remote.quality() == Quality::BAD);
}

TEST_CASE("sequence numbers count by one from 1 [ASE-2]") {
  StationRig rig;
  rig.program->on_idle = [](Cycle& cycle) { cycle.note(9001); };
  for (int i = 0; i < 10; ++i) rig.scan();
  std::uint32_t expected = 0;
  for (const Event& event : rig.events()) CHECK(event.seq == ++expected);
  CHECK(expected == 10);
}

TEST_CASE("full event ring shows a gap in SEQ and then the event that tells how many [ASE-5]") {
  StationRig rig(with_event_ring(4));
  bool noisy = true;
  rig.program->on_idle = [&](Cycle& cycle) {
    if (noisy) cycle.note(9001);
  };
  for (int i = 0; i < 10; ++i) rig.scan();
  noisy = false;
  for (int i = 0; i < 10; ++i) rig.scan();  // nobody reads: nothing is added, nothing is lost twice
  CHECK(rig.station->port().events.dropped() == 6);
  std::vector<Event> events = rig.events();
  REQUIRE(events.size() == 4);
  CHECK(events.back().seq == 4);
  rig.scan();
  events = rig.events();
  REQUIRE(events.size() == 1);
  CHECK(events[0].code == code::events_lost);
  CHECK(events[0].detail == 6);
  CHECK(events[0].seq == 11);
  rig.scan();
  CHECK(rig.events().empty());
}

TEST_CASE("loss of events and events take turns while a flood goes on and the reader is slow [ASE-5]") {
  StationRig rig(with_event_ring(4));
  rig.program->on_idle = [](Cycle& cycle) {
    for (int i = 0; i < 3; ++i) cycle.note(9001);
  };
  std::uint64_t got = 0;
  std::uint64_t told = 0;
  for (int i = 0; i < 1000; ++i) {
    rig.scan();
    Event event;
    if (!rig.station->port().events.pop(event)) continue;
    const bool tells = event.code == code::events_lost;
    told += tells;
    got += !tells;
  }
  CHECK(got + told == 1000);
  CHECK(got >= 490);
  CHECK(told >= 490);
}

TEST_CASE("events read and events told lost add up to those raised [ASE-5]") {
  StationRig rig(with_event_ring(8));
  int burst = 0;
  rig.program->on_idle = [&](Cycle& cycle) {
    for (int i = 0; i < burst; ++i) cycle.note(9001);
  };
  std::uint64_t got = 0;
  std::uint64_t told = 0;
  std::uint32_t last_seq = 0;
  const auto read = [&] {
    for (const Event& event : rig.events()) {
      ++got;
      last_seq = event.seq;
      told = event.code == code::events_lost ? static_cast<std::uint64_t>(event.detail) : told;
    }
  };
  for (int i = 0; i < 500; ++i) {
    burst = i * 7 % 23;
    rig.scan();
    read();
  }
  burst = 0;
  rig.scan();
  read();
  CHECK(told == rig.station->port().events.dropped());
  CHECK(got + told == last_seq);
}

}  // namespace
}  // namespace stationd

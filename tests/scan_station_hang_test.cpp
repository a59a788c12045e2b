// A station whose scan hung: what the watchdog did to it, and how it comes back.
#include <doctest/doctest.h>

#include <vector>

#include "tests/scan_fixture.hpp"

namespace stationd {
namespace {

using test::StationRig;
using enum StationState;

TEST_CASE("station that hung goes to FAULT without a second event; reset announces its end [SCAN-9, ASE-3]") {
  for (const StationState before : {STOPPED, RUNNING, STOPPING}) {
    StationRig rig;
    rig.go(before);
    rig.events();
    rig.station->port().hang(5, 7);
    CHECK_FALSE(rig.permit());
    rig.push(Verb::start);
    rig.scan();
    CHECK(rig.station->state() == FAULT);
    CHECK(rig.station->active_fault() == code::watchdog);
    CHECK(rig.events().empty());
    CHECK_FALSE(rig.permit());
    rig.push(Verb::reset);
    rig.scan();
    CHECK(rig.station->state() == STOPPED);
    const std::vector<Event> events = rig.events();
    REQUIRE(events.size() == 1);
    CHECK(events[0].code == code::watchdog);
    CHECK_FALSE(events[0].active);
  }
}

TEST_CASE("station in FAULT that hung keeps its fault and announces the end of the hang [SCAN-9, ASE-3]") {
  StationRig rig;
  rig.go(FAULT);
  rig.events();
  rig.station->port().hang(5, 7);
  rig.scan();
  CHECK(rig.station->active_fault() == code::overrun);
  const std::vector<Event> events = rig.events();
  REQUIRE(events.size() == 1);
  CHECK(events[0].code == code::watchdog);
  CHECK_FALSE(events[0].active);
}

TEST_CASE("watchdog's event has a number of its own among the scan's [SCAN-9, ASE-2]") {
  StationRig rig;
  rig.go(RUNNING);
  rig.station->fault(code::overrun, 0);
  const std::vector<Event> before = rig.events();
  REQUIRE_FALSE(before.empty());
  rig.station->port().hang(5, 7);
  Event event;
  REQUIRE(rig.station->port().runtime_events.pop(event));
  CHECK(event.seq == before.back().seq + 1);
  CHECK(event.utc_ns == 7);
  rig.push(Verb::reset);
  rig.scan();
  CHECK(rig.events().front().seq == event.seq + 1);
}

}  // namespace
}  // namespace stationd

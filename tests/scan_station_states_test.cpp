// The state machine of a station: orders, faults, permit, safe values.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "tests/scan_fixture.hpp"

namespace stationd {
namespace {

using test::StationRig;
using enum StationState;

/// What can be ordered of a station, or happen to it, between two scans.
enum class Order { start, stop_now, stop_at_end, reset, reset_with_obstacle, fault };

struct Row {
  StationState from;
  Order order;
  StationState to;     ///< after the scan that follows
  Outcome outcome;     ///< of orders with a reply
  std::uint32_t code;  ///< why it was refused
};

constexpr Outcome kDone = Outcome::done;
constexpr Outcome kRefused = Outcome::refused;
constexpr std::uint32_t kObstacle = 2042;

const std::vector<Row>& table() {
  static const std::vector<Row> rows = {
      {STOPPED, Order::start, RUNNING, kDone, 0},
      {STOPPED, Order::stop_now, STOPPED, kRefused, 0},
      {STOPPED, Order::stop_at_end, STOPPED, kRefused, 0},
      {STOPPED, Order::reset, STOPPED, kRefused, code::not_in_fault},
      {STOPPED, Order::reset_with_obstacle, STOPPED, kRefused, code::not_in_fault},
      {STOPPED, Order::fault, FAULT, kRefused, 0},
      {RUNNING, Order::start, RUNNING, kDone, 0},
      {RUNNING, Order::stop_now, STOPPED, kRefused, 0},
      {RUNNING, Order::stop_at_end, STOPPING, kRefused, 0},
      {RUNNING, Order::reset, RUNNING, kRefused, code::not_in_fault},
      {RUNNING, Order::reset_with_obstacle, RUNNING, kRefused, code::not_in_fault},
      {RUNNING, Order::fault, FAULT, kRefused, 0},
      {STOPPING, Order::start, STOPPING, kRefused, code::start_in_wrong_state},
      {STOPPING, Order::stop_now, STOPPED, kRefused, 0},
      {STOPPING, Order::stop_at_end, STOPPING, kRefused, 0},
      {STOPPING, Order::reset, STOPPING, kRefused, code::not_in_fault},
      {STOPPING, Order::reset_with_obstacle, STOPPING, kRefused, code::not_in_fault},
      {STOPPING, Order::fault, FAULT, kRefused, 0},
      {FAULT, Order::start, FAULT, kRefused, code::start_in_wrong_state},
      {FAULT, Order::stop_now, FAULT, kRefused, 0},
      {FAULT, Order::stop_at_end, FAULT, kRefused, 0},
      {FAULT, Order::reset, STOPPED, kDone, 0},
      {FAULT, Order::reset_with_obstacle, FAULT, kRefused, kObstacle},
      {FAULT, Order::fault, FAULT, kRefused, 0},
  };
  return rows;
}

void give(StationRig& rig, Order order) {
  rig.program->obstacle = order == Order::reset_with_obstacle ? kObstacle : 0;
  switch (order) {
    case Order::start: rig.push(Verb::start); break;
    case Order::stop_now: rig.stop(StopMode::immediate); break;
    case Order::stop_at_end: rig.stop(StopMode::end_of_piece); break;
    case Order::reset:
    case Order::reset_with_obstacle: rig.push(Verb::reset); break;
    case Order::fault: rig.station->fault(code::overrun, 0); break;
  }
}

TEST_CASE("station in each state takes or refuses each order as the table says") {
  CHECK(table().size() == 4 * 6);
  for (const Row& row : table()) {
    CAPTURE(static_cast<int>(row.from));
    CAPTURE(static_cast<int>(row.order));
    StationRig rig;
    rig.go(row.from);
    REQUIRE(rig.station->state() == row.from);
    give(rig, row.order);
    rig.scan();
    CHECK(rig.station->state() == row.to);
    const Reply reply = rig.reply();
    CHECK(reply.outcome == row.outcome);
    CHECK(reply.code == row.code);
    CHECK(rig.permit() == driven(row.to));
  }
}

TEST_CASE("station that was never started drives nothing and has no permit") {
  StationRig rig;
  CHECK_FALSE(rig.permit());
  rig.scan();
  CHECK(rig.station->state() == STOPPED);
  CHECK_FALSE(rig.permit());
  CHECK(rig.status().cause == StopCause::never_started);
  CHECK(rig.driven_outputs() == std::vector<Slot>{0, 3, 0});
}

TEST_CASE("station that is started executes from the next scan on, the first one marked") {
  StationRig rig;
  std::vector<bool> marks;
  rig.program->on_execute = [&](Cycle& cycle) { marks.push_back(cycle.started()); };
  rig.push(Verb::start);
  rig.scan();
  CHECK(rig.program->executed == 0);
  rig.scan();
  rig.scan();
  CHECK(marks == std::vector<bool>{true, false});
}

TEST_CASE("station that is stopped before its first execute marks the first one after the next Start") {
  StationRig rig;
  bool idle_marked = false;
  bool marked = false;
  rig.program->on_idle = [&](Cycle& cycle) { idle_marked |= cycle.started(); };
  rig.program->on_execute = [&](Cycle& cycle) { marked = cycle.started(); };
  rig.push(Verb::start);
  rig.scan();
  rig.stop(StopMode::immediate);
  rig.scan();
  CHECK_FALSE(idle_marked);
  rig.push(Verb::start);
  rig.scan();
  rig.scan();
  CHECK(marked);
}

TEST_CASE("station told to end its piece before its first execute still marks it") {
  StationRig rig;
  bool marked = false;
  rig.program->on_execute = [&](Cycle& cycle) { marked = cycle.started() && cycle.finishing(); };
  rig.push(Verb::start);
  rig.scan();
  rig.stop(StopMode::end_of_piece);
  rig.scan();
  CHECK(marked);
}

TEST_CASE("Stop of the same scan beats an older Start [REQ-2]") {
  StationRig rig;
  rig.push(Verb::start);
  rig.stop(StopMode::immediate);
  rig.scan();
  rig.scan();
  CHECK(rig.station->state() == STOPPED);
  CHECK(rig.program->executed == 0);
  CHECK(rig.reply().code == code::start_overtaken);
}

TEST_CASE("Start older than the last Stop is void however late it is serviced [REQ-2]") {
  StationRig rig;
  rig.stop(StopMode::end_of_piece);  // order 1
  rig.scan();
  rig.order = 0;
  rig.push(Verb::start);  // order 1 again is as new, 0 would be older
  rig.scan();
  CHECK(rig.station->state() == RUNNING);
  rig.stop(StopMode::immediate);  // order 2
  rig.scan();
  rig.order = 0;
  rig.push(Verb::start);
  rig.scan();
  CHECK(rig.station->state() == STOPPED);
  CHECK(rig.reply().code == code::start_overtaken);
}

TEST_CASE("Start newer than a Stop latched after the scan began waits for that Stop [REQ-2]") {
  StationRig rig;
  rig.go(RUNNING);
  rig.scan_without_service();
  rig.stop(StopMode::immediate);
  rig.push(Verb::start);
  CHECK_FALSE(rig.station->service_one());
  rig.program->valve = true;
  rig.scan_without_service();
  CHECK(rig.station->state() == STOPPED);
  CHECK(rig.driven_outputs() == std::vector<Slot>{0, 3, 0});
  CHECK(rig.station->service_one());
  CHECK(rig.station->state() == RUNNING);
}

TEST_CASE("immediate Stop is not weakened by end_of_piece of the same scan [REQ-2]") {
  StationRig rig;
  rig.go(RUNNING);
  rig.stop(StopMode::immediate);
  rig.stop(StopMode::end_of_piece);
  rig.scan();
  CHECK(rig.station->state() == STOPPED);
}

TEST_CASE("Stop in STOPPED makes the cause an order") {
  StationRig rig;
  rig.stop(StopMode::immediate);
  rig.scan();
  CHECK(rig.status().cause == StopCause::ordered);
}

TEST_CASE("station that is STOPPING goes on until the program says finished") {
  StationRig rig;
  bool done = false;
  rig.program->on_execute = [&](Cycle& cycle) {
    if (done) cycle.finished();
  };
  rig.go(STOPPING);
  for (int i = 0; i < 5; ++i) rig.scan();
  CHECK(rig.station->state() == STOPPING);
  CHECK(rig.permit());
  done = true;
  rig.scan();
  CHECK(rig.station->state() == STOPPED);
  CHECK(rig.status().cause == StopCause::ordered);
  CHECK_FALSE(rig.permit());
}

TEST_CASE("finished outside STOPPING has no effect, then or later") {
  StationRig rig;
  rig.program->on_execute = [](Cycle& cycle) {
    if (!cycle.finishing()) cycle.finished();
  };
  rig.go(RUNNING);
  rig.scan();
  CHECK(rig.station->state() == RUNNING);
  rig.stop(StopMode::end_of_piece);
  rig.scan();
  CHECK(rig.station->state() == STOPPING);
}

TEST_CASE("fault raised in execute is latched at the end of that scan with safe outputs") {
  StationRig rig;
  rig.go(RUNNING);
  rig.program->on_execute = [&](Cycle& cycle) {
    rig.program->valve = true;
    rig.program->speed = 90;
    cycle.fault(2001, 17);
    cycle.fault(2002, 18);
    CHECK(cycle.state() == RUNNING);
  };
  rig.scan();
  CHECK(rig.station->state() == FAULT);
  CHECK(rig.station->active_fault() == 2001);
  CHECK_FALSE(rig.permit());
  CHECK(rig.driven_outputs() == std::vector<Slot>{0, 3, 0});
  const StatusRecord status = rig.status();
  CHECK(status.state == FAULT);
  CHECK(status.fault == 2001);
  const std::vector<Event> events = rig.events();
  REQUIRE(events.size() == 1);
  CHECK(events[0].code == 2001);
  CHECK(events[0].active);
  CHECK(events[0].detail == 17);
  CHECK(events[0].scan == rig.number);
  CHECK(events[0].utc_ns == rig.now_ns + test::kUtcOffsetNs);
}

TEST_CASE("fault raised in the scan that finishes the piece wins") {
  StationRig rig;
  rig.go(STOPPING);
  rig.program->on_execute = [](Cycle& cycle) {
    cycle.finished();
    cycle.fault(2001);
  };
  rig.scan();
  CHECK(rig.station->state() == FAULT);
}

TEST_CASE("fault raised in idle latches, and a second one does not replace it") {
  StationRig rig;
  std::uint32_t raised = 2001;
  rig.program->on_idle = [&](Cycle& cycle) { cycle.fault(raised); };
  rig.scan();
  raised = 2002;
  rig.scan();
  CHECK(rig.station->active_fault() == 2001);
  CHECK(rig.events().size() == 1);
}

TEST_CASE("reset falls the fault's edge and stands for after_fault; the next Start runs") {
  StationRig rig;
  rig.station->fault(code::overrun, 3);
  rig.scan();
  CHECK(rig.events().size() == 1);
  rig.push(Verb::reset);
  rig.scan();
  const std::vector<Event> events = rig.events();
  REQUIRE(events.size() == 1);
  CHECK(events[0].code == code::overrun);
  CHECK_FALSE(events[0].active);
  rig.scan();
  const StatusRecord status = rig.status();
  CHECK(status.cause == StopCause::after_fault);
  CHECK(status.fault == 0);
  rig.push(Verb::start);
  rig.scan();
  CHECK(rig.station->state() == RUNNING);
  CHECK(rig.permit());
}

TEST_CASE("permit that was revoked from outside returns only by reset, then Start [SCAN-9]") {
  StationRig rig;
  rig.go(RUNNING);
  rig.station->port().permit.store(false);
  rig.push(Verb::start);
  rig.scan();
  CHECK(rig.station->state() == FAULT);
  rig.stop(StopMode::immediate);
  rig.scan();
  CHECK_FALSE(rig.permit());
  rig.push(Verb::reset);
  rig.scan();
  CHECK_FALSE(rig.permit());
  rig.push(Verb::start);
  rig.scan();
  CHECK(rig.permit());
}

TEST_CASE("outputs outside RUNNING are safe, those with hold keep their last value") {
  StationRig rig;
  rig.go(RUNNING);
  rig.program->on_execute = [&](Cycle&) {
    rig.program->valve = true;
    rig.program->speed = 90;
    rig.program->gripper = true;
  };
  rig.scan();
  CHECK(rig.driven_outputs() == std::vector<Slot>{1, 90, 1});
  rig.stop(StopMode::immediate);
  rig.scan();
  CHECK(rig.driven_outputs() == std::vector<Slot>{0, 3, 1});
}

TEST_CASE("outputs set in idle have no effect, not even those with hold") {
  StationRig rig;
  rig.program->on_idle = [&](Cycle&) {
    rig.program->valve = true;
    rig.program->speed = 90;
    rig.program->gripper = true;
  };
  rig.scan();
  CHECK(rig.driven_outputs() == std::vector<Slot>{0, 3, 0});
}

TEST_CASE("outputs in STOPPING are the program's") {
  StationRig rig;
  rig.go(STOPPING);
  rig.program->on_execute = [&](Cycle&) { rig.program->speed = 12; };
  rig.scan();
  CHECK(rig.driven_outputs()[1] == 12);
}

TEST_CASE("Start sets its parameters before the first execute, a refused one sets none [REQ-3]") {
  StationRig rig;
  const TagIndex limit = *rig.station->image().find("limit");
  Request request;
  request.token = 1;
  request.order = 1;
  request.assignment_count = 1;
  request.assignments[0] = {limit, to_slot<std::int32_t>(42)};
  rig.station->fault(code::overrun, 0);
  rig.station->port().requests.push(request);
  rig.scan();
  CHECK(rig.program->limit == 5);
  rig.push(Verb::reset);
  request.order = 3;
  rig.station->port().requests.push(request);
  rig.scan();
  CHECK(rig.program->limit == 42);
  request.order = 4;
  request.assignments[0].value = 77;
  rig.station->port().requests.push(request);
  rig.scan();
  CHECK(rig.program->limit == 42);  // RUNNING already: done, and nothing changed
}

TEST_CASE("get answers with value, quality and state in any state [REQ-1]") {
  StationRig rig;
  rig.feed_device(true, -4);
  Request request;
  request.token = 77;
  request.verb = Verb::get;
  request.tag = *rig.station->image().find("position");
  rig.station->port().requests.push(request);
  rig.scan();
  const Reply reply = rig.reply();
  CHECK(reply.token == 77);
  CHECK(reply.outcome == Outcome::done);
  CHECK(from_slot<std::int32_t>(reply.value) == -4);
  CHECK(reply.quality == Quality::GOOD);
  CHECK(reply.state == STOPPED);
}

TEST_CASE("request without token is carried out without a reply [REQ-1]") {
  StationRig rig;
  rig.push(Verb::start, 0);
  rig.scan();
  CHECK(rig.station->state() == RUNNING);
  Reply reply;
  CHECK_FALSE(rig.station->port().replies.pop(reply));
}

TEST_CASE("requests wait in order while the replies are full, and none is lost [REQ-1]") {
  StationOptions options = StationRig::named("ST");
  options.request_capacity = 4;
  StationRig rig(options);
  for (std::uint64_t token = 1; token <= 4; ++token) rig.push(Verb::reset, token);
  rig.scan();
  for (std::uint64_t token = 5; token <= 8; ++token) rig.push(Verb::reset, token);
  rig.scan();
  std::vector<std::uint64_t> tokens;
  for (int round = 0; round < 3; ++round) {
    Reply reply;
    while (rig.station->port().replies.pop(reply)) tokens.push_back(reply.token);
    rig.scan();
  }
  CHECK(tokens == std::vector<std::uint64_t>{1, 2, 3, 4, 5, 6, 7, 8});
  CHECK(rig.station->port().replies.dropped() == 0);
}

TEST_CASE("status of each scan tells what the program reports") {
  StationRig rig;
  rig.program->on_execute = [](Cycle& cycle) { cycle.report(4, 99, true); };
  rig.go(RUNNING);
  rig.scan();
  const StatusRecord running = rig.status();
  CHECK(running.step == 4);
  CHECK(running.piece == 99);
  CHECK(running.ready);
  CHECK(running.scan == rig.number);
  CHECK(running.time_ns == rig.now_ns);
  CHECK(running.utc_ns == rig.now_ns + test::kUtcOffsetNs);
  CHECK(rig.station->port().progress.load() == rig.number);
  rig.stop(StopMode::end_of_piece);
  rig.scan();
  CHECK_FALSE(rig.status().ready);
}

TEST_CASE("program sees one time, its scan, epoch and state") {
  StationOptions options = StationRig::named("ST");
  options.epoch = 9;
  StationRig rig(options);
  rig.program->on_idle = [&](Cycle& cycle) {
    CHECK(cycle.now_ns() == rig.now_ns);
    CHECK(cycle.scan() == rig.number);
    CHECK(cycle.epoch() == 9);
    CHECK(cycle.state() == STOPPED);
    CHECK(cycle.restart() == Restart::cold);
  };
  rig.scan();
  CHECK(rig.program->idled == 1);
}

}  // namespace
}  // namespace stationd

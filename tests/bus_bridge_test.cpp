// A station behind its bridge, seen from another participant: PVs, Status, events, orders, requests,
// duplicates.
#include <doctest/doctest.h>

#include <memory>

#include "tests/bus_controller.hpp"

namespace stationd::bus::test {
namespace {

TEST_CASE("station when started over the bus then publishes its PVs and Status [PV-1, REQ-3]") {
  Controller controller("robot");
  Desk desk;
  REQUIRE(desk.reaches());
  REQUIRE(desk.sees(StationState::STOPPED));
  desk.start("speed=202 delay=1.5s from=desk id=1");
  REQUIRE(desk.sees(StationState::RUNNING));
  CHECK(eventually([&] {
    return desk.sets.any([](const Set& m) {
      return m.STATION == "robot" && m.CODE == 202 && m.SEQ == 1 && m.EPOCH == 7;
    }) && desk.ends.any([](const End& m) { return m.CODE == 202 && m.ERROR; });
  }));
  CHECK(eventually([&] { return desk.states.all().back().PIECE == 202; }));
  const Status status = desk.states.all().back();
  CHECK(status.STATION == "robot");
  CHECK(status.CONTROLLER == "controller1");
  CHECK(status.EPOCH == 7);
  CHECK(status.READY);
  CHECK(status.STEP == 3);
  CHECK(status.STEP_NAME == "fit");
  CHECK(status.PERIOD_NS == 2'000'000);
  CHECK(status.REALTIME == "none");
  CHECK(status.SCANS > 0);
  desk.stop("from=desk");
  CHECK(desk.sees(StationState::STOPPED));
  desk.start();
  CHECK(desk.sees(StationState::RUNNING));
  desk.stop("mode=end_of_piece");
  CHECK(desk.sees(StationState::STOPPED));
}

TEST_CASE("remote PVs when they arrive then are the station's inputs [PV-4]") {
  Controller controller("robot");
  Desk desk;
  REQUIRE(desk.reaches());
  CHECK(eventually([&] {
    desk.bus.write(Set{"sealer", 999});
    desk.bus.write(Set{"loader", 103, false, 0, 2, 9});
    Status status;
    status.STATION = "sealer";
    status.STATE = 2;
    desk.bus.write(status);
    return controller.scanned.loader_code == 103 && controller.scanned.loader_good &&
           controller.scanned.sealer_state == 2;
  }));
}

TEST_CASE("station when asked then answers each verb with the id it was given [REQ-1]") {
  Controller controller("robot");
  Desk desk;
  REQUIRE(desk.reaches());
  REQUIRE(desk.sees(StationState::STOPPED));
  const MsgRes status = desk.ask("status from=desk id=abc");
  CHECK(status.BODY.find("id=abc station=robot state=STOPPED") == 0);
  CHECK(status.DEST_STATION == "desk");
  CHECK_FALSE(status.ERROR);
  const MsgRes described = desk.ask("describe ST1203 from=desk");
  CHECK(described.CODE == 1203);
  CHECK(described.BODY.find("ST1203 ") == 0);
  CHECK(described.BODY.find("Remedy: ") != std::string::npos);
  CHECK(desk.ask("describe 1203 from=desk").CODE == 1203);
  CHECK(desk.ask("get speed from=desk id=2").BODY == "id=2 speed=101 quality=GOOD state=STOPPED");
  CHECK(desk.ask("get delay from=desk").BODY.find("delay=300ms") == 0);
  CHECK(desk.ask("params from=desk").BODY.find("speed=101 (1..1000)\ndelay=300ms (0s..10s)") == 0);
  const MsgRes reset = desk.ask("reset from=desk id=3");
  CHECK(reset.ERROR);
  CHECK(reset.STATUS == code::not_in_fault);
  CHECK(reset.BODY.find("id=3 refused: ST1302") == 0);
}

TEST_CASE("statistics when published then reach who listens [SCAN-6]") {
  Controller controller("robot");
  Desk desk;
  REQUIRE(eventually([&] { return controller.bridge.stats_readers() == 1; }));
  ScanStats stats;
  stats.STATION = "robot";
  stats.SCANS = 77;
  stats.FIGURES[1][9].max_ns = 5'000'000'000;
  REQUIRE(eventually([&] {
    controller.bridge.publish(stats);
    return desk.stats.size() > 0;
  }));
  CHECK(desk.stats.all()[0].STATION == "robot");
  CHECK(desk.stats.all()[0].SCANS == 77);
  CHECK(desk.stats.all()[0].FIGURES[1][9].max_ns == 5'000'000'000);
}

TEST_CASE("station when asked for a histogram then answers with its buckets [SCAN-6]") {
  Controller controller("robot");
  Desk desk;
  REQUIRE(desk.reaches());
  REQUIRE(desk.sees(StationState::STOPPED));
  CHECK(desk.ask("histogram response from=desk id=4").BODY ==
        "id=4 figure=response window=since_start merged=1 2:500");
  CHECK(desk.ask("histogram execute last_minute from=desk").BODY ==
        "figure=execute window=last_minute merged=1 6:7");
  CHECK(desk.ask("histogram from=desk").STATUS == code::body_invalid);
  CHECK(desk.ask("histogram execute today from=desk").STATUS == code::body_invalid);
  const MsgRes unknown = desk.ask("histogram speed from=desk");
  CHECK(unknown.STATUS == code::value_invalid);
  CHECK(unknown.BODY.find("there are lateness, execution, response, ") != std::string::npos);
}

TEST_CASE("station when in FAULT then is reset over the bus and shows changed parameters [REQ-3]") {
  Controller controller("robot");
  Desk desk;
  REQUIRE(desk.reaches());
  desk.start("fault=true speed=7");
  REQUIRE(desk.sees(StationState::FAULT));
  CHECK(eventually([&] {
    return desk.events.any([](const Gse& m) {
      return m.STATION == "robot" && m.STATUS == code::overrun && m.ERROR && m.ACTIVE && m.SEVERITY == 2 &&
             m.EPOCH == 7 && m.TEXT == "scan overran" && m.DETAIL == 1;
    });
  }));
  CHECK(desk.ask("params from=desk").BODY.find("speed=7 ") == 0);
  CHECK_FALSE(desk.ask("reset from=desk").ERROR);
  CHECK(desk.sees(StationState::STOPPED));
}

TEST_CASE(
    "request when it names something unknown then is refused with its code and changes nothing [REQ-5]") {
  Controller controller("robot");
  Desk desk;
  REQUIRE(desk.reaches());
  const auto refusal = [&](const std::string& body) {
    const MsgRes reply = desk.ask(body + " from=desk id=9");
    CHECK(reply.ERROR);
    CHECK(reply.BODY.find("id=9 ") == 0);
    return reply.STATUS;
  };
  CHECK(refusal("dance") == code::unknown_verb);
  CHECK(refusal("") == code::unknown_verb);
  CHECK(refusal("get nothing") == code::unknown_tag);
  CHECK(refusal("get") == code::body_invalid);
  CHECK(refusal("status now") == code::body_invalid);
  CHECK(refusal("status speed=3") == code::body_invalid);
  CHECK(refusal("describe 99999") == code::value_invalid);
  CHECK(refusal("describe me") == code::body_invalid);
  CHECK(refusal("x\xFF") == code::body_invalid);
  CHECK(refusal(std::string(9000, 'x')) == code::body_invalid);
  desk.bus.write_request({"robot", "status from=desk id=9", Order::STOP});
  REQUIRE(desk.replies.wait_for(11));
  CHECK(desk.replies.all().back().STATUS == code::order_refused);
  CHECK(controller.bridge.figures().orders_refused == 11);
  CHECK(controller.logged("Msg from desk refused"));
}

TEST_CASE("order when ill formed or on the wrong topic then is refused, counted, logged [REQ-3, REQ-5]") {
  Controller controller("robot");
  Desk desk;
  REQUIRE(desk.reaches());
  REQUIRE(desk.sees(StationState::STOPPED));
  const auto refused = [&](std::uint64_t count) {
    return eventually([&] { return controller.bridge.figures().orders_refused == count; });
  };
  for (const char* bad : {"speed=0", "speed=1001", "speed=fast", "delay=11s", "delay=300", "code=5",
                          "nothing=1", "now", "speed=2 nothing=1", "speed=1 speed=2"}) {
    desk.start(bad);
  }
  CHECK(refused(10));
  desk.bus.write_start({"robot", "", Order::STOP});
  CHECK(refused(11));
  CHECK(controller.logged("Start refused: "));
  CHECK(desk.ask("get speed from=desk").BODY.find("speed=101 ") == 0);
  CHECK(desk.states.all().back().STATE == 0);
  desk.start();
  REQUIRE(desk.sees(StationState::RUNNING));
  desk.stop("mode=softly");
  desk.stop("speed=3");
  desk.bus.write_stop({"robot", "", Order::START});
  CHECK(refused(14));
  CHECK(desk.ask("status from=desk").BODY.find("state=RUNNING") != std::string::npos);
}

TEST_CASE("tags when forced and set over the bus then Status, events, answers and the log say so [IMG-3]") {
  Controller controller("robot");
  Desk desk;
  REQUIRE(desk.reaches());
  REQUIRE(desk.sees(StationState::STOPPED));
  CHECK(desk.ask("force loader.code 107 from=desk id=1").BODY ==
        "id=1 tag=loader.code forced=107 state=STOPPED");
  CHECK(eventually([&] { return controller.scanned.loader_code == 107 && controller.scanned.loader_good; }));
  CHECK(eventually([&] { return desk.states.all().back().FORCED == 1; }));
  CHECK(desk.ask("get loader.code from=desk").BODY ==
        "loader.code=107 quality=FORCED forced=107 state=STOPPED");
  CHECK(controller.logged("robot: tag loader.code forced to 107, from=desk"));
  CHECK(eventually([&] {
    return desk.events.any(
        [](const Gse& m) { return m.STATUS == code::tag_forced && m.TEXT == "tag forced: loader.code"; });
  }));
  CHECK(desk.ask("status from=desk").BODY.find(" forced=1 ") != std::string::npos);
  const MsgRes tags = desk.ask("tags from=desk");
  CHECK(tags.BODY.find("tag=loader.code value=107 quality=FORCED area=input type=UDINT forced=107\n") !=
        std::string::npos);
  CHECK(tags.BODY.find("tag=station.running value=false") != std::string::npos);
  CHECK(desk.ask("set speed 300 from=desk id=2").BODY == "id=2 tag=speed value=300 before=101 state=STOPPED");
  CHECK(controller.logged("robot: tag speed set to 300 (was 101), from=desk"));
  CHECK(desk.ask("params from=desk").BODY.find("speed=300") == 0);
  const MsgRes refused = desk.ask("set speed 1001 from=desk");
  CHECK(refused.STATUS == code::value_invalid);
  CHECK(refused.BODY == "speed: 1001 is out of range 1..1000");
  CHECK(desk.ask("unforce all from=desk id=3").BODY == "id=3 tag=all unforced=1 state=STOPPED");
  CHECK(controller.logged("robot: tag loader.code unforced, from=desk"));
  CHECK(eventually([&] { return desk.states.all().back().FORCED == 0 && !controller.scanned.loader_good; }));
}

TEST_CASE("ten clients when they ask at once then each gets its own replies [REQ-1]") {
  Controller controller("robot");
  constexpr int clients = 10, requests = 20;
  std::vector<std::unique_ptr<Desk>> desks;
  for (int i = 0; i < clients; ++i) desks.push_back(std::make_unique<Desk>("desk" + std::to_string(i)));
  for (auto& desk : desks) REQUIRE(desk->reaches());
  for (int k = 0; k < requests; ++k) {
    for (int i = 0; i < clients; ++i) {
      const std::string id = std::to_string(i * 1000 + k);
      desks[static_cast<std::size_t>(i)]->bus.write_request(
          {"robot", "get speed from=desk" + std::to_string(i) + " id=" + id, Order::MSG});
    }
    std::this_thread::sleep_for(
        std::chrono::milliseconds(3));  // less than the station can service: no "busy"
  }
  for (int i = 0; i < clients; ++i) {
    Desk& desk = *desks[static_cast<std::size_t>(i)];
    CHECK(desk.replies.wait_for(requests));
    const auto replies = desk.replies.all();
    CHECK(replies.size() == requests);
    for (std::size_t k = 0; k < replies.size(); ++k) {
      CHECK(replies[k].BODY.find("id=" + std::to_string(i * 1000 + static_cast<int>(k)) + " ") == 0);
    }
  }
}

TEST_CASE("stop when the request queue is full then takes effect at once, and the rest hears busy [REQ-2]") {
  Controller controller("robot", quick("controller1"), 4);
  Desk desk;
  REQUIRE(desk.reaches());
  desk.start();
  REQUIRE(desk.sees(StationState::RUNNING));
  controller.scanned.hold = true;
  for (int i = 0; i < 20; ++i) desk.bus.write_request({"robot", "get speed from=desk", Order::MSG});
  REQUIRE(eventually([&] { return controller.bridge.figures().orders_busy > 0; }));
  REQUIRE(desk.replies.wait_for(1));
  CHECK(desk.replies.all()[0].STATUS == code::busy);
  desk.start("speed=5");
  CHECK(controller.logged("Start not taken"));
  desk.stop();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // it has arrived
  controller.scanned.hold = false;
  CHECK(desk.sees(StationState::STOPPED));
  CHECK(desk.replies.wait_for(20));
}

TEST_CASE("events when the reader comes late then all arrive, in order and once [ASE-2]") {
  Controller controller("robot");
  constexpr std::uint32_t count = 2000;
  {
    Desk early;
    REQUIRE(early.reaches());
    early.start("notes=2000");
    REQUIRE(early.events.wait_for(count));
  }
  Desk late("late");
  REQUIRE(late.events.wait_for(count));
  const auto events = late.events.all();
  CHECK(events.size() == count);
  for (std::uint32_t i = 0; i < count; ++i) CHECK(events[i].SEQ == i + 1);
}

TEST_CASE("second daemon when it has a running station's name then gives way before it says anything") {
  constexpr std::int64_t second = 1'000'000'000;
  Controller first("robot", quick("controller1"), 64, second);  // by its scans it has run for minutes
  Desk desk;
  REQUIRE(desk.reaches());
  REQUIRE(eventually([&] { return !desk.states.all().empty() && desk.states.all().back().SCANS > 60; }));
  BridgeOptions newcomer = quick("controller9");
  newcomer.listen_ns = 30 * second;
  newcomer.newcomer_ns = 30 * second;
  Controller late("robot", newcomer);
  REQUIRE(eventually([&] { return !late.bridge.duplicate_station().empty(); }));
  CHECK(late.bridge.duplicate_station() == "robot");
  CHECK(late.logged("station robot is run by another daemon as well, on controller controller1"));
  CHECK(first.bridge.duplicate_station().empty());
  CHECK_FALSE(desk.states.any([](const Status& m) { return m.CONTROLLER == "controller9"; }));
}

TEST_CASE("daemon when it replaces one that has ended then is no duplicate") {
  { Controller first("robot", quick("controller1")); }
  BridgeOptions restarted = quick("controller1");
  restarted.listen_ns = 200'000'000;
  Controller second("robot", restarted);
  Desk desk;
  CHECK(desk.sees(StationState::STOPPED));
  CHECK(second.bridge.duplicate_station().empty());
}

TEST_CASE("bridge when a PV does not fit its topic then says which [PV-2]") {
  class Wrong : public Program {
   public:
    explicit Wrong(const char* topic, const char* member) { publish(topic, {{member, &value}}); }
    void execute(Cycle&) noexcept override {}
    Var<std::uint64_t> value{*this, "value", ""};
  };
  const auto problem = [](const char* topic, const char* member) -> std::string {
    StationOptions station_options;
    station_options.name = "robot";
    Station station(station_options, std::make_unique<Wrong>(topic, member));
    station.seal();
    Bus bus(options("wrong"));
    try {
      const StationBridge bridge(bus, quick("c"), {{&station, {}}}, {});
    } catch (const BusError& error) {
      return error.what();
    }
    return "none";
  };
  CHECK(problem("Sett", "CODE") == "station robot, PV Sett: a station publishes Set or End");
  CHECK(problem("Set", "CODES") == "station robot, PV Set: PV_Set has no member CODES");
  CHECK(problem("Set", "CODE") == "station robot, PV Set: member CODE is UDINT, tag value is ULINT");
}

}  // namespace
}  // namespace stationd::bus::test

// Two participants on loopback: every topic arrives with all its members; filters, correlation, late readers,
// QoS.
#include <doctest/doctest.h>

#include <atomic>
#include <memory>

#include "tests/bus_support.hpp"

namespace stationd::bus::test {
namespace {

struct Both {
  Bus sender{options("sender")};
  Bus receiver{options("receiver")};
};

bool matched(const Bus& bus, const std::string& topic, int count = 1) {
  return eventually([&] { return bus.matched_readers(topic) >= count; });
}

TEST_CASE("pv_topics when written then arrive with every member [PV-5]") {
  Inbox<Set> sets;
  Inbox<End> ends;
  Inbox<Status> states;
  Both cell;
  Handlers handlers;
  handlers.on_set = [&](const Set& set, const Origin&) { sets.put(set); };
  handlers.on_end = [&](const End& end, const Origin&) { ends.put(end); };
  handlers.on_status = [&](const Status& status, const Origin&) { states.put(status); };
  cell.receiver.start(handlers);
  cell.sender.prepare_writers({"Set", "End", "Status"});
  REQUIRE(matched(cell.sender, "Set"));
  REQUIRE(matched(cell.sender, "End"));
  REQUIRE(matched(cell.sender, "Status"));

  Set set{"loader", 101, true, 7, 3, 42};
  Status status;
  status.STATION = "sealer";
  status.STATE = 1;
  status.READY = true;
  status.CONTROLLER = "controller2";
  status.SCANS = 1ULL << 40U;
  status.STEP_NAME = "press";
  status.REALTIME = "FIFO 80";
  status.SOURCE_TIME = -1;
  // Best effort: a sample that overtakes the reader's own discovery is lost, so it is repeated, as in the
  // cell.
  REQUIRE(eventually([&] {
    CHECK(cell.sender.write(set));
    CHECK(cell.sender.write(End{"robot", 102, true, 2101, 4, 5}));
    CHECK(cell.sender.write(status));
    return sets.size() > 0 && ends.size() > 0 && states.size() > 0;
  }));
  CHECK(sets.all()[0].STATION == "loader");
  CHECK(sets.all()[0].CODE == 101);
  CHECK(sets.all()[0].ERROR);
  CHECK(sets.all()[0].STATUS == 7);
  CHECK(sets.all()[0].EPOCH == 3);
  CHECK(sets.all()[0].SEQ == 42);
  CHECK(ends.all()[0].CODE == 102);
  CHECK(ends.all()[0].STATUS == 2101);
  CHECK(states.all()[0].SCANS == 1ULL << 40U);
  CHECK(states.all()[0].READY);
  CHECK(states.all()[0].STEP_NAME == "press");
  CHECK(states.all()[0].REALTIME == "FIFO 80");
  CHECK(states.all()[0].SOURCE_TIME == -1);
}

TEST_CASE("event_reader when it comes late then receives every event in order [ASE-2]") {
  Inbox<Gse> events;
  Both cell;
  constexpr std::uint32_t count = 500;
  cell.sender.prepare_writers({"GSE"});
  for (std::uint32_t i = 1; i <= count; ++i) {
    Gse event;
    event.STATION = "robot";
    event.SEQ = i;
    event.TEXT = "gripper holds an unknown part";
    REQUIRE(cell.sender.write(event));
  }
  Handlers handlers;
  handlers.on_gse = [&](const Gse& event, const Origin&) { events.put(event); };
  cell.receiver.start(handlers);
  REQUIRE(events.wait_for(count));
  const auto got = events.all();
  CHECK(got.size() == count);
  for (std::uint32_t i = 0; i < count; ++i) CHECK(got[i].SEQ == i + 1);
  CHECK(got[0].TEXT == "gripper holds an unknown part");
}

TEST_CASE("request when answered then the reply names its identity [REQ-1]") {
  Inbox<std::pair<Origin, std::string>> replies;
  Both cell;
  Handlers server;
  server.names = {"robot"};
  server.on_request = [&](const MsgReq& request, const Origin& origin) {
    MsgRes reply;
    reply.DEST_STATION = "client";
    reply.BODY = "re " + request.BODY;
    CHECK(cell.receiver.write_reply(reply, origin));
  };
  cell.receiver.prepare_writers({"Msg_Res"});
  cell.receiver.start(server);
  Handlers client;
  client.names = {"client"};
  client.on_reply = [&](const MsgRes& reply, const Origin&, const Origin& related) {
    replies.put({related, reply.BODY});
  };
  cell.sender.start(client);
  cell.sender.prepare_writers({"Msg_Req"});
  REQUIRE(matched(cell.sender, "Msg_Req"));
  REQUIRE(matched(cell.receiver, "Msg_Res"));
  Origin first, second;
  REQUIRE(cell.sender.write_request({"robot", "one", Order::MSG}, &first));
  REQUIRE(cell.sender.write_request({"robot", "two", Order::MSG}, &second));
  REQUIRE(replies.wait_for(2));
  const auto got = replies.all();
  CHECK(got[0].second == "re one");
  CHECK(got[0].first.sequence == first.sequence);
  CHECK(got[0].first.writer_high == first.writer_high);
  CHECK(got[0].first.writer_low == first.writer_low);
  CHECK(got[1].second == "re two");
  CHECK(got[1].first.sequence == second.sequence);
  CHECK(cell.sender.own(got[0].first));
  CHECK_FALSE(cell.receiver.own(got[0].first));
}

TEST_CASE("content_filter when another station is named then its samples do not arrive [PV-4, REQ-1]") {
  Inbox<std::string> got;
  Both cell;
  Handlers handlers;
  handlers.stations = {"loader", "sealer"};
  handlers.names = {"robot"};
  handlers.on_set = [&](const Set& set, const Origin&) { got.put("set " + set.STATION); };
  handlers.on_stop = [&](const MsgReq& order, const Origin&) { got.put("stop " + order.DEST_STATION); };
  cell.receiver.start(handlers);
  cell.sender.prepare_writers({"Set", "Stop"});
  REQUIRE(matched(cell.sender, "Set"));
  REQUIRE(matched(cell.sender, "Stop"));
  CHECK(cell.sender.write_stop({"loader", "", Order::STOP}));
  CHECK(cell.sender.write_stop({"robot", "", Order::STOP}));
  CHECK(eventually([&] {
    for (const char* station : {"robot", "loader", "sealer", "storage"}) {
      CHECK(cell.sender.write(Set{station, 1}));
    }
    const auto is = [&](const char* text) {
      return got.any([&](const std::string& s) { return s == text; });
    };
    return is("set loader") && is("set sealer") && is("stop robot");
  }));
  CHECK_FALSE(got.any(
      [](const std::string& s) { return s == "set robot" || s == "set storage" || s == "stop loader"; }));
}

TEST_CASE("stop when Starts wait before it then is handed out first with its place in the order [REQ-2]") {
  Inbox<std::pair<std::string, std::uint64_t>> got;
  std::mutex gate;
  std::atomic<bool> waiting{false};
  Both cell;
  gate.lock();
  Handlers handlers;
  handlers.names = {"robot"};
  handlers.on_stop = [&](const MsgReq& order, const Origin& origin) { got.put({order.BODY, origin.order}); };
  handlers.on_start = [&](const MsgReq& order, const Origin& origin) {
    if (order.BODY == "hold") {
      waiting = true;
      const std::lock_guard held(gate);
    }
    got.put({order.BODY, origin.order});
  };
  cell.receiver.start(handlers);
  cell.sender.prepare_writers({"Start", "Stop"});
  REQUIRE(matched(cell.sender, "Start"));
  REQUIRE(matched(cell.sender, "Stop"));
  REQUIRE(cell.sender.write_start({"robot", "hold", Order::START}));
  REQUIRE(eventually([&] { return waiting.load(); }));
  REQUIRE(cell.sender.write_start({"robot", "before", Order::START}));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // so that the times of receipt are apart
  REQUIRE(cell.sender.write_stop({"robot", "stop", Order::STOP}));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  REQUIRE(cell.sender.write_start({"robot", "after", Order::START}));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // all three have arrived
  gate.unlock();
  REQUIRE(got.wait_for(4));
  const auto all = got.all();
  CHECK(all[0] == std::pair<std::string, std::uint64_t>{"hold", 1});
  CHECK(all[1] == std::pair<std::string, std::uint64_t>{"stop", 3});
  CHECK(all[2] == std::pair<std::string, std::uint64_t>{"before", 2});
  CHECK(all[3] == std::pair<std::string, std::uint64_t>{"after", 4});
}

TEST_CASE("oversized key when written then is refused and counted, and nothing stops") {
  Inbox<Set> sets;
  Both cell;
  Handlers handlers;
  handlers.on_set = [&](const Set& set, const Origin&) { sets.put(set); };
  cell.receiver.start(handlers);
  cell.sender.prepare_writers({"Set"});
  REQUIRE(matched(cell.sender, "Set"));
  CHECK_FALSE(cell.sender.write(Set{std::string(300, 'x'), 1}));
  CHECK_FALSE(cell.sender.write(Set{std::string(100'000, 'x'), 1}));
  CHECK(cell.sender.failures() == 2);
  CHECK(eventually([&] {
    CHECK(cell.sender.write(Set{std::string(255, 'x'), 1}));
    return sets.size() > 0;
  }));
}

TEST_CASE("bus when its interface does not exist then says so [SYS]") {
  Options wrong = options("nowhere");
  wrong.interfaces = {"203.0.113.77"};
  CHECK_THROWS_WITH_AS(Bus{wrong}, doctest::Contains("no interface with the address 203.0.113.77"), BusError);
}

TEST_CASE("bus when its domain is out of range then says so [SYS]") {
  Options wrong = options("nowhere");
  wrong.domain = 100;
  CHECK_THROWS_WITH_AS(Bus{wrong}, doctest::Contains("DDS domain 100"), BusError);
  wrong.domain = -1;
  CHECK_THROWS_AS(Bus{wrong}, BusError);
}

}  // namespace
}  // namespace stationd::bus::test

// A flood on one topic or for one station costs the others a turn, not their service.
#include <doctest/doctest.h>

#include <atomic>
#include <string>
#include <thread>

#include "tests/bus_support.hpp"

namespace stationd::bus::test {
namespace {

/// Does something again and again in a thread of its own.
class Flood {
 public:
  template <class Act> explicit Flood(Act act) {
    thread_ = std::thread([this, act] {
      while (!end_) act();
    });
  }
  Flood(const Flood&) = delete;
  Flood& operator=(const Flood&) = delete;
  ~Flood() {
    end_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> end_{false};
  std::thread thread_;
};

/// Slower than whoever floods: the reader of the flooded topic is never empty.
void be_slow() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }

TEST_CASE("stop when one topic is flooded then arrives, and so does all else [REQ-2, ASE-5]") {
  Inbox<std::string> got;
  std::atomic<std::uint64_t> flooded{0};
  Bus sender(options("sender")), receiver(options("receiver"));
  Handlers handlers;
  handlers.names = {"robot", "receiver"};
  handlers.on_gse = [&](const Gse&, const Origin&) {
    ++flooded;
    be_slow();
  };
  handlers.on_set = [&](const Set&, const Origin&) { got.put("set"); };
  handlers.on_status = [&](const Status&, const Origin&) { got.put("status"); };
  handlers.on_stop = [&](const MsgReq&, const Origin&) { got.put("stop"); };
  handlers.on_start = [&](const MsgReq&, const Origin&) { got.put("start"); };
  handlers.on_request = [&](const MsgReq&, const Origin&) { got.put("request"); };
  receiver.start(handlers);
  sender.prepare_writers({"GSE", "Set", "Status", "Stop", "Start", "Msg_Req"});
  for (const char* topic : {"GSE", "Set", "Status", "Stop", "Start", "Msg_Req"})
    REQUIRE(eventually([&] { return sender.matched_readers(topic) > 0; }));
  const Flood flood([&] { sender.write(Gse{}); });
  REQUIRE(eventually([&] { return flooded > 500; }));
  REQUIRE(sender.write_stop({"robot", "", Order::STOP}));
  REQUIRE(sender.write_start({"robot", "", Order::START}));
  REQUIRE(sender.write_request({"robot", "", Order::MSG}));
  const auto arrived = [&](const std::string& what) {
    return eventually([&] {
      sender.write(Set{"robot", 1});  // best effort: repeated, as in the cell
      sender.write(Status{});
      return got.any([&](const std::string& is) { return is == what; });
    });
  };
  for (const char* what : {"stop", "start", "request", "set", "status"}) CHECK(arrived(what));
}

TEST_CASE("reply that waits when one topic is flooded then is sent all the same [REQ-1]") {
  Inbox<std::string> replies;
  std::atomic<std::uint64_t> flooded{0};
  Bus client(options("client")), server(options("server"));
  Handlers asks;
  asks.names = {"client"};
  asks.on_reply = [&](const MsgRes& reply, const Origin&, const Origin&) { replies.put(reply.BODY); };
  client.start(asks);
  Handlers serves;
  serves.on_gse = [&](const Gse&, const Origin&) {
    ++flooded;
    be_slow();
  };
  server.prepare_writers({"Msg_Res"});
  server.start(serves);
  client.prepare_writers({"GSE"});
  REQUIRE(eventually([&] { return server.matched_readers("Msg_Res") > 0; }));
  REQUIRE(eventually([&] { return client.matched_readers("GSE") > 0; }));
  const Flood flood([&] { client.write(Gse{}); });
  REQUIRE(eventually([&] { return flooded > 500; }));
  Origin nobody;  // no reader of replies is known of it: the reply waits
  nobody.writer_high = 1;
  REQUIRE(server.write_reply({"client", 0, false, 0, "waited"}, nobody));
  CHECK(replies.wait_for(1));
}

TEST_CASE("stop when Starts pour in then waits for a turn of them, not for all [REQ-2]") {
  constexpr int stations = 4, each = 250;  // a reader keeps 256 for each station
  constexpr int sent_at = 100;             // in the midst of them
  std::atomic<bool> open{false};
  std::atomic<int> handled{0}, handled_at_stop{-1};
  Bus sender(options("sender")), receiver(options("receiver"));
  Handlers handlers;
  handlers.names = {"s0", "s1", "s2", "s3"};
  handlers.on_start = [&](const MsgReq&, const Origin&) {
    while (!open) be_slow();
    if (++handled == sent_at) CHECK(sender.write_stop({"s3", "", Order::STOP}));
    be_slow();
  };
  handlers.on_stop = [&](const MsgReq&, const Origin&) { handled_at_stop = handled.load(); };
  receiver.start(handlers);
  sender.prepare_writers({"Start", "Stop"});
  REQUIRE(eventually([&] { return sender.matched_readers("Start") > 0; }));
  REQUIRE(eventually([&] { return sender.matched_readers("Stop") > 0; }));
  for (int i = 0; i < each; ++i)
    for (int s = 0; s < stations; ++s) CHECK(sender.write_start({"s" + std::to_string(s), "", Order::START}));
  open = true;
  REQUIRE(eventually([&] { return handled_at_stop >= 0; }));
  CHECK(handled_at_stop < stations * each / 2);
  CHECK(eventually([&] { return handled == stations * each; }));  // and none is lost
}

TEST_CASE("requests for one station when another is flooded then are served [REQ-1, REQ-2]") {
  Inbox<std::string> served;
  std::atomic<std::uint64_t> flooded{0};
  Bus sender(options("sender")), receiver(options("receiver"));
  Handlers handlers;
  handlers.names = {"one", "other"};
  // Which key comes first in the library's own order is not known: each station is once the flooded one.
  std::string target = "one";
  SUBCASE("the one") { target = "other"; }
  SUBCASE("the other") { target = "one"; }
  const std::string noisy = target == "one" ? "other" : "one";
  const auto serve = [&](const MsgReq& message, const Origin&) {
    if (message.DEST_STATION == target) return served.put(message.BODY);
    ++flooded;
    be_slow();
  };
  handlers.on_start = handlers.on_request = handlers.on_stop = serve;
  receiver.start(handlers);
  sender.prepare_writers({"Start", "Stop", "Msg_Req"});
  for (const char* topic : {"Start", "Stop", "Msg_Req"})
    REQUIRE(eventually([&] { return sender.matched_readers(topic) > 0; }));
  const Flood flood([&] {
    sender.write_stop({noisy, "", Order::STOP});
    sender.write_start({noisy, "", Order::START});
    sender.write_request({noisy, "", Order::MSG});
  });
  REQUIRE(eventually([&] { return flooded > 500; }));
  REQUIRE(sender.write_stop({target, "stop", Order::STOP}));
  REQUIRE(sender.write_start({target, "start", Order::START}));
  REQUIRE(sender.write_request({target, "request", Order::MSG}));
  CHECK(served.wait_for(3));
}

}  // namespace
}  // namespace stationd::bus::test

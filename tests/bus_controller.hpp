// A controller with one station behind its bridge, and an operator's desk on another participant.
// Owned by each test.
// The test's thread; what arrives is collected on the bus-in threads.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "tests/bus_station.hpp"
#include "tests/bus_support.hpp"

namespace stationd::bus::test {

inline BridgeOptions quick(const std::string& controller) {
  BridgeOptions options;
  options.controller = controller;
  options.status_period_ns = 20'000'000;
  options.listen_ns = 0;
  return options;
}

/// One controller with one station.
struct Controller {
  explicit Controller(const std::string& name, BridgeOptions bridge_options = quick("controller1"),
                      std::size_t requests = 64, std::int64_t period_ns = 2'000'000)
      : scanned(name, requests), bus(options("controller of " + name)),
        bridge(bus, std::move(bridge_options),
               {{&scanned.station(),
                 [period_ns] {
                   return TaskFigures{period_ns, 1, 2, "none"};
                 },
                 [](Figure figure, Window window) {
                   const std::size_t count = window == Window::since_start ? 500 : 7;
                   return std::vector<BucketCount>{{static_cast<std::size_t>(figure), count}};
                 }}},
               [this](int, const std::string& text) { log.put(text); }) {
    bridge.start();
    scanned.scan(bridge.wake_fd());
  }
  ~Controller() {
    scanned.stop();
    bridge.stop();
  }
  bool logged(const std::string& part) const {
    return eventually([&] {
      return log.any([&](const std::string& line) { return line.find(part) != std::string::npos; });
    });
  }
  Inbox<std::string> log;
  ScannedStation scanned;
  Bus bus;
  StationBridge bridge;
};

/// An operator's desk: hears everything, says anything.
struct Desk {
  explicit Desk(const std::string& name = "desk") : bus(options(name)) {
    Handlers handlers;
    handlers.names = {name};
    handlers.on_set = [this](const Set& m, const Origin&) { sets.put(m); };
    handlers.on_end = [this](const End& m, const Origin&) { ends.put(m); };
    handlers.on_status = [this](const Status& m, const Origin&) { states.put(m); };
    handlers.on_stats = [this](const ScanStats& m, const Origin&) { stats.put(m); };
    handlers.on_gse = [this](const Gse& m, const Origin&) { events.put(m); };
    handlers.on_reply = [this](const MsgRes& m, const Origin&, const Origin&) { replies.put(m); };
    bus.start(handlers);
    bus.prepare_writers({"Start", "Stop", "Msg_Req", "Set", "Status"});
  }
  bool reaches() const {
    return eventually([&] {
      return bus.matched_readers("Start") > 0 && bus.matched_readers("Stop") > 0 &&
             bus.matched_readers("Msg_Req") > 0;
    });
  }
  bool sees(StationState state) const {
    return eventually([&] {
      const auto all = states.all();
      return !all.empty() && all.back().STATE == static_cast<std::uint32_t>(state);
    });
  }
  /// The reply to a request, or one that says that none came.
  MsgRes ask(const std::string& body) {
    const std::size_t before = replies.size();
    bus.write_request({"robot", body, Order::MSG});
    if (!replies.wait_for(before + 1)) return {"", 0, true, 0, "no reply"};
    return replies.all()[before];
  }
  void start(const std::string& body = "") { bus.write_start({"robot", body, Order::START}); }
  void stop(const std::string& body = "") { bus.write_stop({"robot", body, Order::STOP}); }

  Inbox<Set> sets;
  Inbox<End> ends;
  Inbox<Status> states;
  Inbox<ScanStats> stats;
  Inbox<Gse> events;
  Inbox<MsgRes> replies;
  Bus bus;
};

}  // namespace stationd::bus::test

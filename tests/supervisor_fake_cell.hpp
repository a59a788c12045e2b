// Fake stations on the real bus, for end-to-end tests of the supervisor and of stationctl.
// Owned by the test case.
// A thread of its own repeats Status and End; orders come in on the bus-in thread; the test's thread looks.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "dds_bridge/body.hpp"
#include "dds_bridge/bus.hpp"
#include "scan/messages.hpp"

namespace stationd::testing {

inline int test_domain() {
  const char* given = std::getenv("STATIOND_TEST_DOMAIN");
  return given != nullptr && *given != '\0' ? std::atoi(given) : static_cast<int>(::getpid() % 99) + 1;
}

/// Polls until `holds`; false after a generous limit.
inline bool eventually(const std::function<bool()>& holds,
                       std::chrono::seconds limit = std::chrono::seconds(60)) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (std::chrono::steady_clock::now() < end) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return holds();
}

class FakeCell {
 public:
  struct Station {
    bus::Status status;
    bus::End end;
    bool deaf = false;                          ///< orders and requests have no effect
    bool stats = false;                         ///< publishes ScanStats and has a histogram
    std::string answer;                         ///< to `status`; empty: "fake status"
    int starts = 0;                             ///< received
    std::vector<std::string> start_order_seen;  ///< stations RUNNING when its first Start came
  };

  explicit FakeCell(const std::vector<std::string>& names) : bus_(options()) {
    for (const std::string& name : names) {
      Station& station = stations_[name];
      station.status.STATION = name;
      station.status.CONTROLLER = "fake";
      station.status.EPOCH = 1;
      station.status.PERIOD_NS = 10'000'000;
      station.end.STATION = name;
      station.end.EPOCH = 1;
    }
    bus_.prepare_writers({"Status", "End", "ScanStats", "GSE", "Msg_Res"});
    bus::Handlers handlers;
    handlers.on_start = [this](const bus::MsgReq& order, const bus::Origin& origin) {
      on_start(order, origin);
    };
    handlers.on_stop = [this](const bus::MsgReq& order, const bus::Origin&) { on_stop(order); };
    handlers.on_request = [this](const bus::MsgReq& m, const bus::Origin& origin) { on_request(m, origin); };
    handlers.names = names;
    bus_.start(std::move(handlers));
    thread_ = std::thread([this] { repeat(); });
  }
  ~FakeCell() {
    end_ = true;
    thread_.join();
    bus_.stop();
  }
  FakeCell(const FakeCell&) = delete;
  FakeCell& operator=(const FakeCell&) = delete;

  /// Under the lock: looks at or changes a station.
  template <class Work> auto with(const std::string& name, Work work) {
    const std::lock_guard lock(mutex_);
    return work(stations_.at(name));
  }
  bool runs(const std::string& name) {
    return with(name, [](Station& s) { return s.status.STATE == 1; });
  }
  bool all_run() {
    const std::lock_guard lock(mutex_);
    return std::ranges::all_of(stations_, [](const auto& entry) { return entry.second.status.STATE == 1; });
  }
  void finish_piece(const std::string& name) {
    with(name, [](Station& s) {
      ++s.end.SEQ;
      s.end.CODE = 101;
    });
  }
  void raise(const std::string& name, std::uint32_t code, std::uint32_t seq) {
    bus::Gse gse;
    gse.STATION = name;
    gse.STATUS = code;
    gse.EPOCH = 1;
    gse.SEQ = seq;
    gse.SEVERITY = 1;
    gse.ACTIVE = true;
    bus_.write(gse);
  }
  bus::Bus& bus() { return bus_; }

 private:
  static bus::Options options() {
    bus::Options options;
    options.domain = test_domain();
    options.name = "fake";
    return options;
  }

  void on_start(const bus::MsgReq& order, const bus::Origin& origin) {
    const std::lock_guard lock(mutex_);
    Station& station = stations_.at(order.DEST_STATION);
    if (station.starts++ == 0)
      for (const auto& [name, other] : stations_)
        if (other.status.STATE == 1) station.start_order_seen.push_back(name);
    if (!station.deaf && station.status.STATE == 0) station.status.STATE = 1;
    const bus::Body body = bus::parse_body(order.BODY, 8192);
    if (station.deaf || station.status.STATE != 3 || body.id.empty()) return;
    bus::MsgRes reply;
    reply.DEST_STATION = body.from;
    reply.ERROR = true;
    reply.STATUS = 1304;
    reply.BODY = bus::reply_prefix(body) + "Start refused: ST1304 (Start not possible)";
    bus_.write_reply(reply, origin);
  }
  void on_stop(const bus::MsgReq& order) {
    const std::lock_guard lock(mutex_);
    Station& station = stations_.at(order.DEST_STATION);
    if (station.deaf) return;
    const bool gentle =
        order.BODY.find("mode=end_of_piece") != std::string::npos && station.status.STATE == 1;
    station.status.STATE = gentle ? 2 : 0;
    station.status.STOP_CAUSE = 1;
  }
  void on_request(const bus::MsgReq& request, const bus::Origin& origin) {
    const bus::Body body = bus::parse_body(request.BODY, 8192);
    const std::lock_guard lock(mutex_);
    Station& station = stations_.at(request.DEST_STATION);
    if (station.deaf) return;
    const bool known = !body.words.empty() && (body.words[0] == "status" || body.words[0] == "reset");
    bus::MsgRes reply;
    reply.DEST_STATION = body.from;
    if (station.stats && body.words[0] == "histogram") {
      reply.BODY =
          bus::reply_prefix(body) + "figure=" + body.words.at(1) + " window=since_start merged=1 1000:5";
      bus_.write_reply(reply, origin);
      return;
    }
    reply.ERROR = !known;
    reply.STATUS = known ? 0 : 1307;
    reply.BODY = bus::reply_prefix(body) + (known ? "fake " + body.words[0] : "not a verb");
    if (known && body.words[0] == "status" && !station.answer.empty())
      reply.BODY = bus::reply_prefix(body) + station.answer;
    if (known && body.words[0] == "reset" && station.status.STATE == 3) station.status.STATE = 0;
    bus_.write_reply(reply, origin);
  }
  static bus::ScanStats stats_of(const std::string& name) {
    bus::ScanStats stats;
    stats.STATION = name;
    stats.TASK = "fake";
    stats.TASK_STATIONS = 1;
    stats.PERIOD_NS = 10'000'000;
    stats.SCANS = 12;
    return stats;
  }
  void repeat() {
    while (!end_) {
      {
        const std::lock_guard lock(mutex_);
        for (auto& [name, station] : stations_) {
          station.status.SCANS += 5;
          bus_.write(station.status);
          bus_.write(station.end);
          if (station.stats) bus_.write(stats_of(name));
        }
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  std::mutex mutex_;
  std::map<std::string, Station> stations_;
  std::atomic<bool> end_{false};
  bus::Bus bus_;
  std::thread thread_;  ///< last: it uses all of them
};

}  // namespace stationd::testing

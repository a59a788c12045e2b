// The supervisor over real DDS on loopback, against fake stations: start order, operator's orders, counts,
// answers,
// two of one name (issue item "Supervisor"; REQ 4).
#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "supervisor/application.hpp"
#include "tests/supervisor_fake_cell.hpp"

using namespace stationd;
using namespace stationd::supervisor;
using stationd::testing::eventually;
using stationd::testing::FakeCell;

namespace {

class SilentScreen final : public Screen {
 public:
  void notes(const std::vector<std::string>& lines) override {
    const std::lock_guard lock(mutex_);
    for (const std::string& line : lines) text_ += line + "\n";
  }
  void update(const Model&, std::int64_t) override {}
  void close() override {}
  bool said(const std::string& part) {
    const std::lock_guard lock(mutex_);
    return text_.find(part) != std::string::npos;
  }
  std::string text() {
    const std::lock_guard lock(mutex_);
    return text_;
  }

 private:
  std::mutex mutex_;
  std::string text_;
};

config::SupervisorConfiguration configuration() {
  config::SupervisorConfiguration configuration;
  configuration.stations = {"storage", "sealer", "loader"};
  configuration.start_repeat_ns = 200'000'000;
  configuration.bus.domain = stationd::testing::test_domain();
  configuration.bus.name = "supervisor";
  return configuration;
}

/// A supervisor in its own thread.
class Running {
 public:
  explicit Running(StateStore& store, const Arguments& arguments = {})
      : application_(configuration(), arguments, store, screen), thread_([this] {
          application_.run(stop_);
          ended_ = true;
        }) {}
  ~Running() { end(); }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  void end() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  bool ended() const { return ended_; }
  SilentScreen screen;

 private:
  Application application_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

/// A client that asks the supervisor.
class Asker {
 public:
  Asker() : bus_(options()) {
    bus_.prepare_writers({"Msg_Req", "Start", "Stop"});
    bus::Handlers handlers;
    handlers.on_reply = [this](const bus::MsgRes& reply, const bus::Origin&, const bus::Origin&) {
      const std::lock_guard lock(mutex_);
      reply_ = reply;
    };
    handlers.names = {"asker"};
    bus_.start(std::move(handlers));
  }
  bool asks(const std::string& words, const std::string& expected) {
    return eventually([&] {
      bus_.write_request({"supervisor", words + " from=asker id=5", bus::Order::MSG});
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      const std::lock_guard lock(mutex_);
      return reply_ && reply_->BODY.find(expected) != std::string::npos;
    });
  }
  bus::Bus& bus() { return bus_; }

 private:
  static bus::Options options() {
    bus::Options options = configuration().bus;
    options.name = "asker";
    return options;
  }
  std::mutex mutex_;
  std::optional<bus::MsgRes> reply_;
  bus::Bus bus_;
};

}  // namespace

TEST_CASE("stations are started in order and confirmed; a station that was killed is started again") {
  FakeCell cell({"storage", "sealer", "loader"});
  MemoryStateStore store;
  Running supervisor(store);
  REQUIRE(eventually([&] { return cell.all_run(); }));
  using Names = std::vector<std::string>;
  CHECK(cell.with("storage", [](auto& s) { return s.start_order_seen; }) == Names{});
  CHECK(cell.with("sealer", [](auto& s) { return s.start_order_seen; }) == Names{"storage"});
  CHECK(cell.with("loader", [](auto& s) { return s.start_order_seen; }) == Names{"sealer", "storage"});
  cell.with("sealer", [](auto& s) {
    s.status.EPOCH = 2;
    s.status.STATE = 0;
    s.status.STOP_CAUSE = 0;
  });
  CHECK(eventually([&] { return cell.runs("sealer"); }));
}

TEST_CASE("Start is repeated until it is confirmed") {
  FakeCell cell({"storage", "sealer", "loader"});
  cell.with("storage", [](auto& s) { s.deaf = true; });
  MemoryStateStore store;
  Running supervisor(store);
  REQUIRE(eventually([&] { return cell.with("storage", [](auto& s) { return s.starts >= 3; }); }));
  CHECK(cell.with("sealer", [](auto& s) { return s.starts; }) == 0);
  cell.with("storage", [](auto& s) { s.deaf = false; });
  CHECK(eventually([&] { return cell.all_run(); }));
}

TEST_CASE(
    "what an operator stopped stays stopped, also after both were restarted, until an operator starts it") {
  FakeCell cell({"storage", "sealer", "loader"});
  MemoryStateStore store;
  auto supervisor = std::make_unique<Running>(store);
  REQUIRE(eventually([&] { return cell.all_run(); }));
  Asker operator_;
  REQUIRE(operator_.asks("status loader", "state=RUNNING"));
  REQUIRE(eventually([&] {
    operator_.bus().write_stop({"loader", "from=asker", bus::Order::STOP});
    return !cell.runs("loader");
  }));
  REQUIRE(operator_.asks("status loader", "intent=stopped"));
  supervisor.reset();
  cell.with("loader", [](auto& s) {
    s.status.EPOCH = 2;
    s.status.STOP_CAUSE = 0;
    s.starts = 0;
  });
  supervisor = std::make_unique<Running>(store);
  REQUIRE(eventually([&] { return supervisor->screen.said("this supervisor commands the cell"); }));
  REQUIRE(operator_.asks("status loader", "epoch=2"));
  CHECK(cell.with("loader", [](auto& s) { return s.starts; }) == 0);
  REQUIRE(eventually([&] {
    operator_.bus().write_start({"loader", "from=asker", bus::Order::START});
    return cell.runs("loader");
  }));
  CHECK(operator_.asks("status loader", "intent=run"));
}

TEST_CASE("pieces are counted once, go on over a restart, and end the run") {
  FakeCell cell({"storage", "sealer", "loader"});
  MemoryStateStore store;
  Arguments arguments;
  arguments.pieces = 3;
  auto supervisor = std::make_unique<Running>(store, arguments);
  REQUIRE(eventually([&] { return cell.all_run(); }));
  cell.finish_piece("storage");
  REQUIRE(eventually([&] { return supervisor->screen.said("storage finished piece 1"); }));
  supervisor.reset();
  CHECK(store.state["storage"].pieces.counted == 1);
  supervisor = std::make_unique<Running>(store, arguments);
  cell.finish_piece("storage");
  REQUIRE(eventually([&] { return supervisor->screen.said("storage finished piece 2"); }));
  CHECK_FALSE(supervisor->ended());
  cell.finish_piece("storage");
  CHECK(eventually([&] { return supervisor->ended(); }));
}

TEST_CASE("it answers questions and lists events [REQ-4]") {
  FakeCell cell({"storage", "sealer", "loader"});
  MemoryStateStore store;
  Running supervisor(store);
  Asker asker;
  CHECK(asker.asks("describe ST1101", "id=5 ST1101 field device lost"));
  CHECK(asker.asks("dance", "unknown verb dance"));
  CHECK(asker.asks("status sealer", "station=sealer state="));
  cell.raise("sealer", 1101, 1);
  cell.raise("sealer", 1101, 4);
  CHECK(eventually([&] { return supervisor.screen.said("ST1101 field device lost (2 lost before)"); }));
}

TEST_CASE("of two supervisors of one name the second observes") {
  FakeCell cell({"storage", "sealer", "loader"});
  MemoryStateStore store;
  Running first(store);
  REQUIRE(eventually([&] { return first.screen.said("this supervisor commands the cell"); }));
  Running second(store);
  CHECK(eventually([&] { return second.screen.said("another supervisor of this name commands the cell"); }));
  CHECK_FALSE(second.screen.said("this supervisor commands the cell"));
}

TEST_CASE("an observer counts and orders nothing") {
  FakeCell cell({"storage", "sealer", "loader"});
  NullStateStore store;
  Arguments arguments;
  arguments.observe = true;
  arguments.name = "panel";
  Running observer(store, arguments);
  cell.finish_piece("storage");
  CHECK(eventually([&] { return observer.screen.said("storage finished piece 1"); }));
  CHECK(cell.with("storage", [](auto& s) { return s.starts; }) == 0);
}

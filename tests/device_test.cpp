// A device's rounds: outputs by permit, inputs published, loss and return told. One test has a thread.
#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "io/device.hpp"
#include "io/null_backend.hpp"

namespace stationd::io {
namespace {

constexpr std::int64_t kMs = 1'000'000;

std::int64_t virtual_now_ns = 0;
std::int64_t virtual_clock() { return virtual_now_ns; }

/// What the device was asked, and what it is to answer.
struct Field {
  ExchangeResult result;
  std::vector<Slot> inputs = {0, 0};
  std::vector<std::vector<OutputValue>> written;
  bool closed = false;
  int closes = 0;
  bool heals_when_closed = false;  ///< a new connection is good
};

class FakeBackend final : public Backend {
 public:
  explicit FakeBackend(Field& field) : field_(field) {}
  ExchangeResult exchange(std::span<const OutputValue> outputs, std::span<Slot> inputs,
                          std::int64_t) override {
    field_.written.emplace_back(outputs.begin(), outputs.end());
    std::copy(field_.inputs.begin(), field_.inputs.end(), inputs.begin());
    return field_.result;
  }
  void close() noexcept override {
    field_.closed = true;
    ++field_.closes;
    if (field_.heals_when_closed) field_.result = {};
  }

 private:
  Field& field_;
};

Point output(SafeAction action, Slot safe) {
  Point point;
  point.direction = Direction::output;
  point.safe_action = action;
  point.safe_value = safe;
  return point;
}

DeviceOptions options() {
  DeviceOptions o;
  o.name = "io-1";
  o.kind = DeviceKind::null;
  return o;
}

/// A device with two inputs and three outputs (off, 7, hold) of one station; the test plays the scan.
struct Rig {
  Field field;
  std::atomic<bool> permit{false};
  InputLink inputs{"io-1", LinkTags{{0, 1}, {2, 2}}, 50 * kMs, 500 * kMs};
  OutputLink outputs{"io-1", LinkTags{{2, 3, 4}, {3, 3}}};
  std::vector<std::string> lines;
  Device device{options(),
                std::make_unique<FakeBackend>(field),
                {Point{}, output(SafeAction::value, 0), Point{}, output(SafeAction::value, 7),
                 output(SafeAction::hold, 0)},
                {DeviceBinding{&inputs, &outputs, &permit, {1, 0}, {0, 1, 2}}},
                [this](int, const std::string& text) { lines.push_back(text); },
                virtual_clock};

  Rig() { virtual_now_ns = 1'000 * kMs; }

  void commit(Slot a, Slot b, Slot c) {
    const BlockView block{outputs.blocks.writable(), outputs.tags.layout};
    block.header() = {virtual_now_ns, 0, 1, 1, Quality::GOOD};
    const Slot values[] = {a, b, c};
    std::copy(std::begin(values), std::end(values), block.slots().begin());
    outputs.blocks.publish();
  }
  /// A round 10 ms after the last; what was written in it, "-" where nothing is.
  std::string round() {
    virtual_now_ns += 10 * kMs;
    device.round(virtual_now_ns);
    return last();
  }
  std::string last() const {
    std::string out;
    for (const OutputValue& value : field.written.back())
      out += (out.empty() ? "" : " ") + (value.write ? std::to_string(value.value) : "-");
    return out;
  }
  /// The permit is there and the program's values stand.
  void drive() {
    permit = true;
    round();
    commit(1, 2, 3);
    REQUIRE(round() == "1 2 3");
  }
  void fail(ExchangeStatus status) { field.result = {status, "read di 0..1", 110}; }
  void heal() { field.result = {}; }
};

}  // namespace

TEST_CASE("outputs before the first Start are safe, whatever the scan commits [IO-6]") {
  Rig rig;
  CHECK(rig.round() == "0 7 -");
  rig.commit(1, 2, 3);
  CHECK(rig.round() == "0 7 -");
}

TEST_CASE("program's outputs stand from the first block after the permit was seen [SCAN-9]") {
  Rig rig;
  rig.round();
  rig.commit(1, 2, 0);  // from before Start: what is to be held has no value yet
  rig.permit = true;
  CHECK(rig.round() == "0 7 -");
  CHECK(rig.round() == "0 7 -");
  rig.commit(1, 2, 3);
  CHECK(rig.round() == "1 2 3");
  CHECK(rig.round() == "1 2 3");
}

TEST_CASE("outputs are safe in the very round after the permit is gone [SCAN-9]") {
  Rig rig;
  rig.drive();
  rig.permit = false;
  CHECK(rig.round() == "0 7 -");
  rig.commit(4, 5, 6);
  CHECK(rig.round() == "0 7 -");
}

TEST_CASE("inputs are published with the time after the read, in the order of the link [IMG-2]") {
  Rig rig;
  rig.field.inputs = {11, 22};
  rig.round();
  REQUIRE(rig.inputs.blocks.update());
  const ConstBlockView block{rig.inputs.blocks.readable(), rig.inputs.tags.layout};
  CHECK(block.header().time_ns == virtual_now_ns);
  CHECK(block.header().count == 1);
  CHECK(block.header().quality == Quality::GOOD);
  CHECK(block.slots()[0] == 22);
  CHECK(block.slots()[1] == 11);
  CHECK(block.qualities()[1] == Quality::GOOD);
  rig.round();
  REQUIRE(rig.inputs.blocks.update());
  CHECK(ConstBlockView{rig.inputs.blocks.readable(), rig.inputs.tags.layout}.header().count == 2);
}

TEST_CASE("failed round publishes nothing, so that its inputs grow old [IO-3]") {
  Rig rig;
  rig.round();
  REQUIRE(rig.inputs.blocks.update());
  rig.fail(ExchangeStatus::timeout);
  rig.round();
  CHECK(!rig.inputs.blocks.update());
}

TEST_CASE("device that comes back gets safe values first, then the program's [IO-3]") {
  Rig rig;
  rig.drive();
  rig.fail(ExchangeStatus::timeout);
  CHECK(rig.round() == "1 2 3");  // this is the round that failed
  CHECK(rig.round() == "0 7 -");
  rig.heal();
  CHECK(rig.round() == "0 7 -");
  CHECK(rig.round() == "1 2 3");
}

TEST_CASE("each change is one line, with what failed and how long it lasted [IO-3]") {
  Rig rig;
  for (int i = 0; i < 200; ++i) rig.round();
  rig.fail(ExchangeStatus::timeout);
  for (int i = 0; i < 200; ++i) rig.round();
  rig.heal();
  for (int i = 0; i < 200; ++i) rig.round();
  REQUIRE(rig.lines.size() == 3);
  CHECK(rig.lines[0] == "device io-1: connected");
  CHECK(rig.lines[1] == "device io-1: lost: no answer in time (read di 0..1): Connection timed out");
  CHECK(rig.lines[2] == "device io-1: back after 2000 ms, safe values first");
}

TEST_CASE("device that flickers gives one line a second and says how many it stands for [IO-3]") {
  Rig rig;
  for (int i = 0; i < 100; ++i) {
    rig.fail(ExchangeStatus::disconnected);
    rig.round();
    rig.heal();
    rig.round();
  }
  CHECK(rig.lines.size() <= 3);
  CHECK(rig.lines.back().find("changes before this were not said") != std::string::npos);
}

TEST_CASE("device that flickers and then stays away is said to be away [IO-3]") {
  Rig rig;
  rig.round();
  rig.fail(ExchangeStatus::disconnected);
  for (int i = 0; i < 200; ++i) rig.round();
  CHECK(rig.lines.back().find("lost") != std::string::npos);
}

TEST_CASE("counters tell good rounds and failures by their kind [IO-3]") {
  Rig rig;
  rig.round();
  rig.fail(ExchangeStatus::exception);
  rig.round();
  const DeviceCounters& counters = rig.device.counters();
  CHECK(counters.exchanges == 1);
  CHECK(counters.failures == 1);
  CHECK(counters.failures_by_status[static_cast<std::size_t>(ExchangeStatus::exception)] == 1);
  CHECK(!counters.connected);
  CHECK(rig.device.last_error() == "the device refused (read di 0..1), Modbus exception 110");
}

TEST_CASE("last act is a round of safe values, then the connection's end [IO-6]") {
  Rig rig;
  rig.drive();
  rig.device.finish(virtual_now_ns);
  CHECK(rig.last() == "0 7 -");
  CHECK(rig.field.closed);
}

TEST_CASE("last act over a connection that is gone is tried once more over a new one [IO-6]") {
  Rig rig;
  rig.drive();
  rig.fail(ExchangeStatus::disconnected);  // lost, perhaps rounds ago: it waits for its next attempt
  rig.round();
  rig.field.heals_when_closed = true;
  const std::size_t rounds = rig.field.written.size();
  rig.device.finish(virtual_now_ns);
  CHECK(rig.field.written.size() == rounds + 2);
  CHECK(rig.last() == "0 7 -");
  CHECK(rig.device.counters().connected);
  CHECK(rig.field.closes == 2);
  for (const std::string& line : rig.lines) CHECK(line.find("NOT written") == std::string::npos);
}

TEST_CASE("last act that does not reach the device is said, and ends [IO-3, IO-6]") {
  Rig rig;
  rig.drive();
  rig.fail(ExchangeStatus::timeout);
  const std::size_t rounds = rig.field.written.size();
  rig.device.finish(virtual_now_ns);
  CHECK(rig.field.written.size() == rounds + 2);
  CHECK(rig.lines.back() ==
        "device io-1: safe values NOT written at the end: no answer in time (read di 0..1): Connection timed "
        "out");
}

TEST_CASE("write_safe writes values and leaves what is to be held [IO-6]") {
  Field field;
  FakeBackend backend(field);
  const std::vector<Point> points = {Point{}, Point{}, output(SafeAction::value, 5),
                                     output(SafeAction::hold, 1)};
  CHECK(write_safe(backend, points, 0).status == ExchangeStatus::ok);
  REQUIRE(field.written.size() == 1);
  CHECK(field.written[0][0].value == 5);
  CHECK(field.written[0][0].write);
  CHECK(!field.written[0][1].write);
}

TEST_CASE("thread exchanges on its grid and ends with a safe round [IO-6]") {
  Field field;
  std::atomic<bool> permit{false};
  DeviceOptions fast = options();
  fast.period_ns = kMs;
  Device device(fast, std::make_unique<FakeBackend>(field), {Point{}, Point{}, output(SafeAction::value, 7)},
                {DeviceBinding{nullptr, nullptr, &permit, {}, {}}}, {});
  device.start();
  while (device.counters().exchanges < 20) std::this_thread::yield();
  device.request_stop();
  device.stop();
  CHECK(field.closed);
  CHECK(field.written.size() == device.counters().exchanges);
  CHECK(field.written.back()[0].value == 7);
}

TEST_CASE("null device reads zeroes and is always there [IO-1]") {
  NullBackend backend;
  std::vector<Slot> inputs = {5, 6};
  CHECK(backend.exchange({}, inputs, 0).status == ExchangeStatus::ok);
  CHECK(inputs == std::vector<Slot>{0, 0});
}

}  // namespace stationd::io

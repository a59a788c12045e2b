// The Modbus back end against a server that misbehaves on demand (modbus_faults.py).
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <thread>

#include <doctest/doctest.h>

#include "io/modbus/modbus_backend.hpp"
#include "tests/modbus_peer.hpp"

namespace stationd::io {
namespace {

constexpr std::int64_t kS = 1'000'000'000;

Point at(Direction direction, Table table, int address, TagType type = TagType::BOOL) {
  Point point;
  point.table = table;
  point.address = static_cast<std::uint16_t>(address);
  point.type = type;
  point.direction = direction;
  return point;
}

std::vector<Point> some_points() {
  const auto in = Direction::input, out = Direction::output;
  return {at(in, Table::discrete_input, 0),
          at(in, Table::discrete_input, 3),
          at(in, Table::input_register, 0, TagType::UDINT),
          at(in, Table::input_register, 2, TagType::INT),
          at(out, Table::coil, 0),
          at(out, Table::coil, 1),
          at(out, Table::coil, 2),
          at(out, Table::holding_register, 0, TagType::UINT)};
}

DeviceOptions options_for(int port) {
  DeviceOptions options;
  options.name = "test";
  options.port = static_cast<std::uint16_t>(port);
  options.timeout_ns = 150'000'000;
  return options;
}

/// Server, back end and the values of one round. Time goes on by 10 s per round: no back-off is in the way.
struct Rig {
  ModbusPeer server{{"/usr/bin/python3", STATIOND_SOURCE_DIR "/tests/modbus_faults.py"}};
  ModbusBackend backend{options_for(server.port()), some_points()};
  std::vector<OutputValue> outputs = std::vector<OutputValue>(4);
  std::vector<Slot> inputs = std::vector<Slot>(4);
  std::int64_t now_ns = 0;

  ExchangeResult round() {
    now_ns += 10 * kS;
    return backend.exchange(outputs, inputs, now_ns);
  }
  ExchangeStatus status_with(const std::string& fault) {
    server.ask("fault " + fault);
    return round().status;
  }
};

struct FaultCase {
  std::string name;
  ExchangeStatus expected;
};

int closed_port() {
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(bind(fd, reinterpret_cast<sockaddr*>(&any), sizeof any) == 0);
  socklen_t size = sizeof any;
  getsockname(fd, reinterpret_cast<sockaddr*>(&any), &size);
  ::close(fd);
  return ntohs(any.sin_port);
}

}  // namespace

TEST_CASE("round writes all outputs and reads all inputs with one request per table [IO-2]") {
  Rig rig;
  rig.server.ask("set di 0 1 0 0 1");
  rig.server.ask("set ir 0 1 2 65535");
  rig.outputs = {{1, true}, {0, true}, {1, true}, {4711, true}};
  REQUIRE(rig.round().status == ExchangeStatus::ok);
  CHECK(rig.inputs == std::vector<Slot>{1, 1, 65538, to_slot(std::int16_t{-1})});
  CHECK(rig.server.ask("get co 0 4") == "1 0 1 0");
  CHECK(rig.server.ask("get hr 0 2") == "4711 0");
  CHECK(rig.server.ask("requests") == "15:0:3 16:0:1 2:0:4 4:0:3");
}

TEST_CASE("held outputs keep what the device has [IO-6]") {
  Rig rig;
  rig.server.ask("set co 0 1 1 1");
  rig.server.ask("set hr 0 9");
  rig.outputs = {{0, true}, {0, false}, {0, true}, {0, false}};
  REQUIRE(rig.round().status == ExchangeStatus::ok);
  CHECK(rig.server.ask("get co 0 3") == "0 1 0");
  CHECK(rig.server.ask("get hr 0 1") == "9");
  CHECK(rig.server.ask("requests") == "15:0:1 15:2:1 2:0:4 4:0:3");
}

TEST_CASE("refused connection is said at once, and waits before the next attempt [IO-3]") {
  ModbusBackend backend(options_for(closed_port()), some_points());
  std::vector<OutputValue> outputs(4);
  std::vector<Slot> inputs(4);
  const ExchangeResult first = backend.exchange(outputs, inputs, 0);
  CHECK(first.status == ExchangeStatus::disconnected);
  CHECK(first.code == ECONNREFUSED);
  const ExchangeResult second = backend.exchange(outputs, inputs, 1);
  CHECK(second.status == ExchangeStatus::disconnected);
  CHECK(second.code == 0);
  CHECK(backend.exchange(outputs, inputs, kS).code == ECONNREFUSED);
}

TEST_CASE("connection that is given up is made anew at once, whatever the back-off [IO-6]") {
  ModbusBackend backend(options_for(closed_port()), some_points());
  std::vector<OutputValue> outputs(4);
  std::vector<Slot> inputs(4);
  for (std::int64_t now_ns = 0; now_ns < 60 * kS; now_ns += 10 * kS)
    backend.exchange(outputs, inputs, now_ns);
  CHECK(backend.exchange(outputs, inputs, 50 * kS + 1).code == 0);  // it waits
  backend.close();
  CHECK(backend.exchange(outputs, inputs, 50 * kS + 2).code == ECONNREFUSED);
}

TEST_CASE("exchange that waits for a silent device is ended from another thread [IO-3]") {
  ModbusPeer server({"/usr/bin/python3", STATIOND_SOURCE_DIR "/tests/modbus_faults.py"});
  DeviceOptions options = options_for(server.port());
  options.timeout_ns = 3'600 * kS;
  ModbusBackend backend(options, some_points());
  std::vector<OutputValue> outputs(4);
  std::vector<Slot> inputs(4);
  REQUIRE(backend.exchange(outputs, inputs, 0).status == ExchangeStatus::ok);
  server.ask("requests");
  server.ask("fault silent");
  std::thread blocked([&] { CHECK(backend.exchange(outputs, inputs, kS).status != ExchangeStatus::ok); });
  while (server.ask("requests").empty()) std::this_thread::yield();  // it has asked, so it waits
  backend.interrupt();
  blocked.join();  // else the test would wait for an hour
  CHECK(backend.exchange(outputs, inputs, 100 * kS).status != ExchangeStatus::ok);  // nor does the next one
}

TEST_CASE("each fault of a device is told by its kind and the next round is good again [IO-3]") {
  Rig rig;
  REQUIRE(rig.round().status == ExchangeStatus::ok);
  const std::vector<FaultCase> faults = {{"silent", ExchangeStatus::timeout},
                                         {"short", ExchangeStatus::timeout},
                                         {"drip", ExchangeStatus::timeout},
                                         {"late", ExchangeStatus::timeout},
                                         {"close", ExchangeStatus::disconnected},
                                         {"reset", ExchangeStatus::disconnected},
                                         {"wrong-unit", ExchangeStatus::protocol},
                                         {"wrong-transaction", ExchangeStatus::protocol},
                                         {"wrong-protocol", ExchangeStatus::protocol},
                                         {"wrong-function", ExchangeStatus::protocol},
                                         {"wrong-echo", ExchangeStatus::protocol},
                                         {"garbage", ExchangeStatus::protocol},
                                         {"twice", ExchangeStatus::protocol},
                                         {"exception", ExchangeStatus::exception}};
  for (const FaultCase& fault : faults) {
    CHECK_MESSAGE(rig.status_with(fault.name) == fault.expected, fault.name);
    CHECK_MESSAGE(rig.status_with("good") == ExchangeStatus::ok, fault.name);
  }
}

TEST_CASE("reply with more values than asked for is refused [IO-3]") {
  Rig rig;
  CHECK(rig.status_with("wrong-count") == ExchangeStatus::protocol);
}

TEST_CASE("exception keeps the connection, every other failure closes it [IO-3]") {
  Rig rig;
  REQUIRE(rig.round().status == ExchangeStatus::ok);
  const ExchangeResult refused = (rig.server.ask("fault exception"), rig.round());
  CHECK(refused.code == 6);
  CHECK(std::string(refused.detail) == "write co 0..2");
  CHECK(rig.status_with("good") == ExchangeStatus::ok);
  CHECK(rig.server.ask("connections") == "1");
  CHECK(rig.status_with("wrong-unit") == ExchangeStatus::protocol);
  CHECK(rig.status_with("good") == ExchangeStatus::ok);
  CHECK(rig.server.ask("connections") == "2");
}

TEST_CASE("device that drips or is silent holds up a round for about one time-out [IO-3]") {
  Rig rig;
  for (const char* fault : {"drip", "silent"}) {
    rig.server.ask(std::string("fault ") + fault);
    CHECK(rig.round().status == ExchangeStatus::timeout);  // and not ok, when the last byte has dripped in
  }
}

TEST_CASE("server that others wrote takes outputs and gives inputs of every table [IO-1]") {
  ModbusPeer server({"/usr/bin/python3", STATIOND_SOURCE_DIR "/tests/modbus_pymodbus.py"});
  const auto in = Direction::input, out = Direction::output;
  const std::vector<Point> points = {at(out, Table::coil, 0),
                                     at(out, Table::coil, 9),
                                     at(out, Table::holding_register, 0, TagType::LREAL),
                                     at(in, Table::coil, 9),
                                     at(in, Table::discrete_input, 19),
                                     at(in, Table::holding_register, 0, TagType::LREAL),
                                     at(in, Table::input_register, 0, TagType::UDINT)};
  ModbusBackend backend(options_for(server.port()), points);
  const std::vector<OutputValue> outputs = {{0, true}, {1, true}, {to_slot(2.5), true}};
  std::vector<Slot> inputs(4);
  REQUIRE(backend.exchange(outputs, inputs, 0).status == ExchangeStatus::ok);
  CHECK(inputs == std::vector<Slot>{1, 1, to_slot(2.5), 0x00010002});
}

TEST_CASE("heartbeat counts up at its own period [IO-6]") {
  ModbusPeer server({"/usr/bin/python3", STATIOND_SOURCE_DIR "/tests/modbus_faults.py"});
  DeviceOptions options = options_for(server.port());
  options.heartbeat_period_ns = kS;
  options.heartbeat_register = 100;
  ModbusBackend backend(options, {});
  for (std::int64_t now_ns = 0; now_ns < 3 * kS; now_ns += kS / 4)
    REQUIRE(backend.exchange({}, {}, now_ns).status == ExchangeStatus::ok);
  CHECK(server.ask("get hr 100 1") == "3");
  CHECK(server.ask("requests") == "6:100:1 6:100:2 6:100:3");
}

TEST_CASE("descriptor that select cannot take is refused, not fatal [IO-3]") {
  Rig rig;
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  const rlimit more{4096, limit.rlim_max};
  REQUIRE(setrlimit(RLIMIT_NOFILE, &more) == 0);
  std::vector<int> taken;
  while (taken.empty() || taken.back() < 1024) taken.push_back(open("/dev/null", O_RDONLY | O_CLOEXEC));
  const ExchangeResult result = rig.round();
  CHECK(result.status == ExchangeStatus::disconnected);
  CHECK(result.code == EMFILE);
  for (const int fd : taken) ::close(fd);
  CHECK(rig.round().status == ExchangeStatus::ok);
}

TEST_CASE("thousand failures leave no descriptor behind [IO-3]") {
  Rig rig;
  const int before = dup(0);
  ::close(before);
  rig.server.ask("fault close");
  for (int i = 0; i < 1000; ++i) CHECK(rig.round().status == ExchangeStatus::disconnected);
  const int after = dup(0);
  ::close(after);
  CHECK(after == before);
}

}  // namespace stationd::io

// The plant behind Modbus/TCP frames, and in process as a field device.
#include <doctest/doctest.h>

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/plant/modbus_pdu.hpp"
#include "io/plant/plantsim_options.hpp"
#include "io/plant/simulated_backend.hpp"

using namespace stationd;
using namespace stationd::plant;

namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::int64_t kMs = 1'000'000;

/// A request with its header; transaction 0x1234.
Bytes frame(std::uint8_t unit, const Bytes& pdu) {
  Bytes bytes(7 + pdu.size());
  bytes[0] = 0x12;
  bytes[1] = 0x34;
  bytes[5] = static_cast<std::uint8_t>(pdu.size() + 1);
  bytes[6] = unit;
  std::copy(pdu.begin(), pdu.end(), bytes.begin() + 7);
  return bytes;
}

/// The PDU of the answer; the header is checked here.
Bytes ask(Plant& plant, std::uint8_t unit, const Bytes& pdu) {
  Reply reply{};
  const std::size_t length = answer(plant, frame(unit, pdu), reply);
  CHECK(reply[0] == 0x12);
  CHECK(reply[1] == 0x34);
  CHECK(reply[5] == length - 6);
  CHECK(reply[6] == unit);
  return {reply.begin() + 7, reply.begin() + static_cast<std::ptrdiff_t>(length)};
}

io::Point point(const char* tag, io::Table table, std::uint16_t address, TagType type,
                io::Direction direction) {
  io::Point made;
  made.tag = tag;
  made.table = table;
  made.address = address;
  made.type = type;
  made.direction = direction;
  return made;
}

/// A file of this process, gone at the end.
class TemporaryFile {
 public:
  TemporaryFile() : path_("/tmp/stationd_plant_test." + std::to_string(::getpid()) + ".json") {}
  ~TemporaryFile() { static_cast<void>(::unlink(path_.c_str())); }
  const std::string& path() const { return path_; }
  std::string text() const {
    std::ifstream file(path_);
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  std::string path_;
};

}  // namespace

TEST_CASE("Frame cut anywhere is incomplete, whole it is complete (IO-5)") {
  const Bytes whole = frame(1, {3, 0, 0, 0, 1});
  for (std::size_t length = 0; length < whole.size(); ++length) {
    CHECK(first_frame({whole.data(), length}).status == FrameStatus::incomplete);
  }
  CHECK(first_frame(whole).status == FrameStatus::complete);
  CHECK(first_frame(whole).length == whole.size());
}

TEST_CASE("Frame of another protocol or an impossible length is garbage (IO-5)") {
  CHECK(first_frame(Bytes{'G', 'E', 'T', ' '}).status == FrameStatus::garbage);
  CHECK(first_frame(Bytes{0, 1, 0, 0, 0, 0}).status == FrameStatus::garbage);
  CHECK(first_frame(Bytes{0, 1, 0, 0, 0, 1}).status == FrameStatus::garbage);
  CHECK(first_frame(Bytes{0, 1, 0, 0, 0, 255}).status == FrameStatus::garbage);
  CHECK(first_frame(Bytes{0, 1, 0, 0, 255, 255}).status == FrameStatus::garbage);
}

TEST_CASE("Read requests are answered from the unit's own table (IO-5)") {
  Plant plant;
  plant.unit(2).coils[8] = true;
  plant.unit(2).holding_registers[0] = 0x0304;
  CHECK(ask(plant, 2, {1, 0, 0, 0, 9}) == Bytes{1, 2, 0, 1});
  CHECK(ask(plant, 2, {2, 0, 3, 0, 4}) == Bytes{2, 1, 0b0101});
  CHECK(ask(plant, 2, {3, 0, 0, 0, 1}) == Bytes{3, 2, 3, 4});
  CHECK(ask(plant, 2, {4, 0, 2, 0, 2}) == Bytes{4, 4, 0, 1, 0, 50});
  CHECK(ask(plant, 1, {1, 0, 0, 0, 9}) == Bytes{1, 2, 0, 0});
}

TEST_CASE("Write requests reach the coils and holding registers and are echoed (IO-5)") {
  Plant plant;
  CHECK(ask(plant, 3, {5, 0, 3, 0xFF, 0}) == Bytes{5, 0, 3, 0xFF, 0});
  CHECK(plant.unit(3).coils[3]);
  CHECK(ask(plant, 3, {15, 0, 0, 0, 9, 2, 0x02, 0x01}) == Bytes{15, 0, 0, 0, 9});
  CHECK_FALSE(plant.unit(3).coils[3]);
  CHECK(plant.unit(3).coils[1]);
  CHECK(plant.unit(3).coils[8]);
  CHECK(ask(plant, 3, {6, 0, 1, 1, 2}) == Bytes{6, 0, 1, 1, 2});
  CHECK(plant.unit(3).holding_registers[1] == 0x0102);
  CHECK(ask(plant, 3, {16, 0, 0, 0, 2, 4, 0, 5, 0, 6}) == Bytes{16, 0, 0, 0, 2});
  CHECK(plant.unit(3).holding_registers[1] == 6);
  CHECK(ask(plant, 3, {22, 0, 0, 0, 0xF2, 0, 0x25}) == Bytes{22, 0, 0, 0, 0xF2, 0, 0x25});
  CHECK(plant.unit(3).holding_registers[0] == 5);
  CHECK(ask(plant, 3, {23, 0, 0, 0, 2, 0, 1, 0, 1, 2, 0, 9}) == Bytes{23, 4, 0, 5, 0, 9});
}

TEST_CASE(
    "Request beyond a table, of a wrong count or an unknown function or unit is refused by its exception "
    "(IO-5)") {
  Plant plant;
  CHECK(ask(plant, 1, {1, 0, 0, 0, 10}) == Bytes{0x81, 2});
  CHECK(ask(plant, 1, {2, 0, 20, 0, 1}) == Bytes{0x82, 2});
  CHECK(ask(plant, 1, {4, 0xFF, 0xFF, 0, 125}) == Bytes{0x84, 2});
  CHECK(ask(plant, 1, {3, 0, 0, 0, 0}) == Bytes{0x83, 3});
  CHECK(ask(plant, 1, {3, 0, 0, 0, 126}) == Bytes{0x83, 3});
  CHECK(ask(plant, 1, {3, 0, 0, 0}) == Bytes{0x83, 3});
  CHECK(ask(plant, 1, {5, 0, 0, 0x12, 0}) == Bytes{0x85, 3});
  CHECK(ask(plant, 1, {6, 0, 2, 0, 0}) == Bytes{0x86, 2});
  CHECK(ask(plant, 1, {15, 0, 0, 0, 9, 1, 0xFF}) == Bytes{0x8F, 3});
  CHECK(ask(plant, 1, {16, 0, 1, 0, 2, 4, 0, 1, 0, 2}) == Bytes{0x90, 2});
  CHECK(ask(plant, 1, {16, 0, 0, 0, 2, 4, 0, 1}) == Bytes{0x90, 3});
  CHECK(ask(plant, 1, {7}) == Bytes{0x87, 1});
  CHECK(ask(plant, 5, {3, 0, 0, 0, 1}) == Bytes{0x83, 0x0B});
  CHECK(ask(plant, 0, {3, 0, 0, 0, 1}) == Bytes{0x83, 0x0B});
}

TEST_CASE("Each of a hundred thousand random frames is answered within a frame's size (IO-5)") {
  Plant plant;
  std::mt19937 random(1);
  std::uniform_int_distribution<unsigned> function(0, 24), length(1, 253), unit(0, 5);
  std::geometric_distribution<unsigned> sparse(0.3);  // small numbers: many requests come near the tables
  for (int i = 0; i < 100'000; ++i) {
    Bytes pdu(length(random));
    for (std::uint8_t& byte : pdu) byte = static_cast<std::uint8_t>(sparse(random));
    pdu[0] = static_cast<std::uint8_t>(function(random));
    Reply reply{};
    const std::size_t size = answer(plant, frame(static_cast<std::uint8_t>(unit(random)), pdu), reply);
    REQUIRE(size >= 9);
    REQUIRE(size <= kAduMax);
  }
}

TEST_CASE("Simulated device exchanges outputs and inputs with its unit (IO-5)") {
  PlantConfig config;
  config.codes = {0x0001'0002};
  auto shared = std::make_shared<io::SharedPlant>(config, LiveOptions{});
  io::SimulatedBackend backend(
      shared, 1,
      {point("loader.conveyor", io::Table::coil, 0, TagType::BOOL, io::Direction::output),
       point("loader.pallet_at_entry", io::Table::discrete_input, 0, TagType::BOOL, io::Direction::input),
       point("loader.arm_target", io::Table::holding_register, 0, TagType::UINT, io::Direction::output),
       point("loader.base_1_level", io::Table::input_register, 3, TagType::UINT, io::Direction::input),
       point("loader.heartbeat", io::Table::holding_register, 0, TagType::UDINT, io::Direction::input)});
  std::vector<io::OutputValue> outputs{{1, true}, {4, true}};
  std::vector<Slot> inputs(3);
  for (std::int64_t now_ns = 0; now_ns <= 2000 * kMs; now_ns += 10 * kMs) {
    CHECK(backend.exchange(outputs, inputs, 5'000'000 * kMs + now_ns).status == io::ExchangeStatus::ok);
  }
  CHECK(inputs[0] == 1);
  CHECK(inputs[1] == 50);
  CHECK(inputs[2] == 4 << 16);
  outputs[0] = {0, false};
  CHECK(backend.exchange(outputs, inputs, 5'002'010 * kMs).status == io::ExchangeStatus::ok);
  CHECK(shared->with(5'002'010 * kMs, [](Plant& plant) { return plant.unit(1).coils[0]; }));
}

TEST_CASE("Simulated device refuses points that the plant does not have (IO-5)") {
  auto shared = std::make_shared<io::SharedPlant>(io::PlantOptions{});
  const auto make = [&](int unit, io::Table table, std::uint16_t address, TagType type,
                        io::Direction direction) {
    io::SimulatedBackend backend(shared, unit, {point("loader.x", table, address, type, direction)});
  };
  const auto in = io::Direction::input, out = io::Direction::output;
  CHECK_NOTHROW(make(1, io::Table::discrete_input, 19, TagType::BOOL, in));
  CHECK_THROWS_WITH_AS(make(1, io::Table::discrete_input, 20, TagType::BOOL, in),
                       "loader.x: the simulated plant has no discrete input 20, only 0 to 19",
                       std::invalid_argument);
  CHECK_THROWS_AS(make(5, io::Table::coil, 0, TagType::BOOL, out), std::invalid_argument);
  CHECK_THROWS_AS(make(1, io::Table::coil, 0, TagType::UINT, out), std::invalid_argument);
  CHECK_THROWS_AS(make(1, io::Table::discrete_input, 0, TagType::BOOL, out), std::invalid_argument);
  CHECK_THROWS_AS(make(1, io::Table::input_register, 6, TagType::UDINT, in), std::invalid_argument);
  CHECK_THROWS_AS(make(1, io::Table::input_register, 0, TagType::BOOL, in), std::invalid_argument);
}

TEST_CASE("Live plant follows real time times its speed, and stands still while its process does (IO-5)") {
  LivePlant live({}, {2.0, {}, {}});
  live.advance(7'000 * kMs);
  CHECK(live.plant().now_ns() == 0);
  live.advance(7'500 * kMs);
  CHECK(live.plant().now_ns() == 1'000 * kMs);
  live.advance(100'000 * kMs);
  CHECK(live.plant().now_ns() == 3'000 * kMs);
  live.advance(100'500 * kMs);
  CHECK(live.plant().now_ns() == 4'000 * kMs);
}

TEST_CASE("Ledger file is written a few times a second and for the last time at the end (IO-5)") {
  const TemporaryFile file;
  {
    io::SharedPlant shared({}, {1.0, file.path(), {}});
    shared.with(0, [](Plant&) {});
    CHECK(shared.write_due(0).empty());
    CHECK(file.text().find("\"final\": false") != std::string::npos);
    shared.with(400 * kMs, [](Plant&) {});
    CHECK(shared.write_due(200 * kMs).empty());
    CHECK(file.text().find("\"pallets\": 0") != std::string::npos);
    CHECK(shared.write_due(400 * kMs).empty());
    CHECK(file.text().find("\"pallets\": 1") != std::string::npos);
  }
  CHECK(file.text().find("\"final\": true") != std::string::npos);
}

TEST_CASE("Ledger file that cannot be written is said and the plant goes on (IO-5)") {
  io::SharedPlant shared({}, {1.0, "/nonexistent/ledger.json", {}});
  shared.with(0, [](Plant&) {});
  CHECK(shared.write_due(0).find("/nonexistent/ledger.json.tmp") != std::string::npos);
}

TEST_CASE("Plantsim's options are read in both spellings (IO-5)") {
  const std::vector<const char*> given{
      "--port=0", "--speed",           "10",     "--codes", "101,103",      "--quiet",    "--seed", "3",
      "--inject", "infeed_stops:1@1s", "--step", "10ms",    "--magazine=7", "--watchdog", "200ms"};
  const PlantsimOptions options = parse_plantsim_options(given);
  CHECK(options.port == 0);
  CHECK(options.quiet);
  CHECK(options.plant.seed == 3);
  CHECK(options.plant.codes == std::vector<std::uint32_t>{101, 103});
  CHECK(options.plant.step_ns == 10 * kMs);
  CHECK(options.plant.magazine_capacity == 7);
  CHECK(options.plant.watchdog_ns == 2'000 * kMs);
  CHECK(options.faults.size() == 1);
}

TEST_CASE("Plantsim's options that are not there or out of range are refused by name (IO-5)") {
  const auto refused = [](std::vector<const char*> given) {
    CHECK_THROWS_AS(parse_plantsim_options(given), std::invalid_argument);
  };
  refused({"--prot", "1"});
  refused({"extra"});
  refused({"--port"});
  refused({"--port", "65536"});
  refused({"--port", "12x"});
  refused({"--speed", "0"});
  refused({"--speed", "nan"});
  refused({"--codes", "101,,102"});
  refused({"--ledger", ""});
  refused({"--watchdog", "5"});
  refused({"--inject", "sensor:1.0=2"});
}

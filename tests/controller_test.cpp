// A controller built from a shipped configuration, its log kept in memory: build, start, progress, end.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "daemon/catalogue.hpp"
#include "daemon/controller.hpp"
#include "tests/bus_support.hpp"

namespace stationd {
namespace {

namespace fs = std::filesystem;
using bus::test::eventually;
using bus::test::Inbox;

class LinesOutput final : public LogOutput {
 public:
  explicit LinesOutput(Inbox<std::string>& lines) : lines_(lines) {}
  void write(const LogRecord& record) override { lines_.put(std::string(record.text)); }

 private:
  Inbox<std::string>& lines_;
};

/// A state directory and a log of the test's own, and the cell in one daemon.
class Rig {
 public:
  Rig() : configuration(load()) {
    std::string name = (fs::temp_directory_path() / "stationd-controller-XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    state = name;
    configuration.state_dir = state;
    configuration.bus.domain = bus::test::domain();
    configuration.bus.cell = bus::test::options("").cell;
  }
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;
  ~Rig() { fs::remove_all(state); }

  bool said(const std::string& part) {
    log.flush();
    return lines.any([&](const std::string& line) { return line.find(part) != std::string::npos; });
  }

  Inbox<std::string> lines;
  config::Configuration configuration;
  fs::path state;
  Log log{"c", LogSeverity::info, std::make_unique<LinesOutput>(lines)};

 private:
  static config::Configuration load() {
    const config::ProgramCatalogue catalogue = program_catalogue();
    auto loaded =
        config::load_controller(fs::path(STATIOND_SOURCE_DIR) / "config/cell-in-process.toml", &catalogue);
    REQUIRE(loaded);
    return std::move(*loaded.value);
  }
};

std::vector<std::string> files_of(const fs::path& directory) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(directory))
    names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  return names;
}

TEST_CASE("Controller when started then scans, counts and ends with its tags saved (SYS-1)") {
  Rig rig;
  Controller controller(rig.configuration, rig.log);
  CHECK_FALSE(controller.first_scans_done());
  CHECK(controller.status_line() == "4 stations, 0 scans, 0 deadline misses");
  const std::vector<RtGrant> grants = controller.start_scans();
  CHECK(grants.size() >= 2);  // memory, and the priority of one task at least
  controller.start_field();
  REQUIRE(eventually([&] { return controller.first_scans_done(); }));
  controller.refuse_duplicate();
  controller.housekeep(monotonic_ns());
  CHECK(controller.status_line() != "4 stations, 0 scans, 0 deadline misses");
  CHECK(controller.stop());
  CHECK(controller.stop());  // a second time: nothing
  CHECK(rig.said("real-time rights: "));
  CHECK(rig.said("station loader: epoch 1, cold start"));
  std::vector<std::string> expected = {"cell.lock"};
  for (const char* station : {"loader", "robot", "sealer", "storage"})
    expected.push_back("cell." + std::string(station) + ".retained.0");
  const std::vector<std::string> files = files_of(rig.state);
  for (const std::string& name : expected) CHECK(std::ranges::count(files, name) == 1);
}

TEST_CASE("Controller when it is started again then goes on warm with the next epoch (IMG-4, IMG-5)") {
  Rig rig;
  { const Controller first(rig.configuration, rig.log); }
  { const Controller second(rig.configuration, rig.log); }
  CHECK(rig.said("station robot: epoch 1, cold start"));
  CHECK(rig.said("station robot: epoch 2, warm start"));
}

TEST_CASE("Controllers of two names with stations of one name then share no retained data (IMG-4)") {
  Rig rig;
  config::Configuration other = rig.configuration;
  other.name = "other";
  { const Controller first(rig.configuration, rig.log); }
  { const Controller first(rig.configuration, rig.log); }
  const std::size_t before = rig.lines.size();
  { const Controller second(other, rig.log); }
  rig.log.flush();
  const auto lines = rig.lines.all();
  CHECK(std::count(lines.begin() + static_cast<std::ptrdiff_t>(before), lines.end(),
                   "station robot: epoch 1, cold start") == 1);
}

TEST_CASE(
    "Controller when it finds retained data of the old name then says that it takes them over (IMG-4)") {
  Rig rig;
  { const Controller first(rig.configuration, rig.log); }
  fs::rename(rig.state / "cell.robot.retained.0", rig.state / "robot.retained.0");
  { const Controller second(rig.configuration, rig.log); }
  CHECK(rig.said("station robot: retained data taken over: " + (rig.state / "robot.retained.0").string()));
  CHECK(rig.said("station robot: epoch 2, warm start"));
}

TEST_CASE(
    "Controller when its retained data are damaged then says so and starts cold, above any epoch (IMG-4)") {
  Rig rig;
  { const Controller first(rig.configuration, rig.log); }
  std::ofstream(rig.state / "cell.robot.retained.0", std::ios::trunc) << "damage";
  { const Controller second(rig.configuration, rig.log); }
  CHECK(rig.said("station robot: retained data refused: "));
  CHECK(rig.said("kept aside as"));
  CHECK_FALSE(rig.said("station robot: epoch 2"));
}

TEST_CASE("Controller when its name is taken then refuses, and says by whom it is held (SYS-1)") {
  Rig rig;
  const Controller first(rig.configuration, rig.log);
  CHECK_THROWS_WITH_AS(Controller(rig.configuration, rig.log),
                       doctest::Contains("controller \"cell\" is already running: its lock"), AlreadyRunning);
}

TEST_CASE("Controller when its state directory cannot be made then says what to set (SYS-1)") {
  Rig rig;
  std::ofstream(rig.state / "file") << "x";
  rig.configuration.state_dir = rig.state / "file" / "below";
  CHECK_THROWS_WITH_AS(Controller(rig.configuration, rig.log),
                       doctest::Contains("set [controller] state_dir"), StateDirectoryError);
}

TEST_CASE("Controller when it cannot watch a device's outputs then names it at start (IO-6)") {
  Rig rig;
  for (io::DeviceOptions& device : rig.configuration.devices) {
    device.kind = io::DeviceKind::modbus;
    device.port = 9;  // nobody there
  }
  rig.configuration.devices[1].heartbeat_period_ns = 100'000'000;
  Controller controller(rig.configuration, rig.log);
  controller.start_scans();
  CHECK(rig.said("device plant-1 has no heartbeat"));
  CHECK_FALSE(rig.said("device plant-2 has no heartbeat"));
  CHECK(controller.stop());
}

TEST_CASE("Controller when a device is not reached then says so in one line (IO-3)") {
  Rig rig;
  for (io::DeviceOptions& device : rig.configuration.devices) {
    device.kind = io::DeviceKind::modbus;
    device.port = 9;  // nobody there
  }
  Controller controller(rig.configuration, rig.log);
  controller.start_scans();
  controller.start_field();
  const std::string line = "device plant-1 (127.0.0.1:9 unit 1): not reached: ";
  CHECK(eventually([&] { return rig.said(line); }));
  CHECK(controller.stop());
  rig.log.flush();
  const auto lines = rig.lines.all();
  CHECK(std::ranges::count_if(lines, [&](const std::string& is) { return is.starts_with(line); }) == 1);
}

}  // namespace
}  // namespace stationd

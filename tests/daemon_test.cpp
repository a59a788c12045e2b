#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "config/config.hpp"
#include "daemon/catalogue.hpp"
#include "daemon/device_points.hpp"
#include "daemon/miss_report.hpp"

using namespace stationd;

namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;

CycleRecord late(std::uint64_t scan, std::int64_t response_ns) {
  CycleRecord record;
  record.scan = scan;
  record.response_ns = response_ns;
  record.execute_ns = response_ns / 2;
  record.lateness_ns = response_ns / 4;
  record.committed_late = true;
  record.slowest = 1;
  record.slowest_ns = 5'000'000;
  return record;
}

std::string field(const MissReport::Line& line, const std::string& name) {
  const auto found =
      std::find_if(line.fields.begin(), line.fields.end(), [&](const auto& f) { return f.first == name; });
  REQUIRE(found != line.fields.end());
  return found->second;
}

}  // namespace

TEST_CASE("Recipe that is given twice is reported once, however many stations take it (CFG-1)") {
  const config::ProgramCatalogue catalogue = program_catalogue();
  const std::filesystem::path file =
      std::filesystem::path(STATIOND_SOURCE_DIR) / "config/cell-in-process.toml";
  std::ifstream in(file);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  REQUIRE(text.find("code = 102") != std::string::npos);
  text.replace(text.find("code = 102"), 10, "code = 101");
  const auto loaded = config::parse_controller(text, "cell.toml", &catalogue);
  REQUIRE(loaded.problems.size() == 1);
  CHECK(loaded.problems[0].text.find("found 101 a second time; codes must differ") != std::string::npos);
}

TEST_CASE("Miss report without a miss says nothing (SCAN-4)") {
  MissReport report("fast", {"robot"});
  CHECK_FALSE(report.due(kSecondNs, 0).has_value());
}

TEST_CASE("Miss report of one miss names task, scan, times and phase (SCAN-4)") {
  MissReport report("fast", {"loader", "robot"});
  report.add(late(41, 12'000'000));
  const auto line = report.due(5 * kSecondNs, 1);
  REQUIRE(line.has_value());
  CHECK(line->text.find("task fast (loader, robot), 1 miss ") != std::string::npos);
  CHECK(line->text.find("scan 41") != std::string::npos);
  CHECK(line->text.find("execute took 6000.0 us (most: robot, execution 5000.0 us)") != std::string::npos);
  CHECK(field(*line, "STATIOND_SLOWEST") == "robot");
  CHECK(field(*line, "STATIOND_PHASE_NS") == "6000000");
  CHECK(field(*line, "STATIOND_SCAN") == "41");
  CHECK(field(*line, "STATIOND_PHASE") == "execute");
  CHECK(field(*line, "STATIOND_RESPONSE_NS") == "12000000");
}

TEST_CASE("Miss report of a late wake-up says so (SCAN-4)") {
  MissReport report("fast", {"robot"});
  CycleRecord record = late(7, 12'000'000);
  record.lateness_ns = 11'000'000;
  record.execute_ns = 900'000;
  report.add(record);
  const auto line = report.due(kSecondNs, 1);
  REQUIRE(line.has_value());
  CHECK(line->text.find("scan 7, woken late by 11000.0 us; lateness") != std::string::npos);
  CHECK(line->text.find(" took ") == std::string::npos);
  CHECK(field(*line, "STATIOND_PHASE") == "waking");
}

TEST_CASE("Miss report names the phase behind the commit only when the outputs were in time (SCAN-4)") {
  for (const bool committed_late : {true, false}) {
    CAPTURE(committed_late);
    MissReport report("fast", {"robot"});
    CycleRecord record = late(7, 4'000'000);
    record.publish_ns = 9'000'000;
    record.committed_late = committed_late;
    record.skipped = 1;
    report.add(record);
    const auto line = report.due(kSecondNs, 1);
    REQUIRE(line.has_value());
    CHECK(field(*line, "STATIOND_PHASE") == (committed_late ? "execute" : "publish"));
    CHECK(field(*line, "STATIOND_SKIPPED") == "1");
  }
}

TEST_CASE("Miss report of many misses in a second is one line that counts them all (SCAN-4)") {
  MissReport report("fast", {"robot"});
  report.add(late(1, 11'000'000));
  REQUIRE(report.due(kSecondNs, 1).has_value());
  report.add(late(2, 30'000'000));
  report.add(late(3, 20'000'000));
  CHECK_FALSE(report.due(kSecondNs + kSecondNs / 2, 3).has_value());
  const auto line = report.due(2 * kSecondNs, 500);
  REQUIRE(line.has_value());
  CHECK(field(*line, "STATIOND_COUNT") ==
        "499");  // the exact counter, not the records that fitted into the ring
  CHECK(field(*line, "STATIOND_SCAN") == "2");
  CHECK_FALSE(report.due(4 * kSecondNs, 500).has_value());
}

TEST_CASE("Points of a device keep the order of each station's tags (IO-2)") {
  const config::ProgramCatalogue catalogue = program_catalogue();
  const auto loaded = config::load_controller(
      std::filesystem::path(STATIOND_SOURCE_DIR) / "config/controller1.toml", &catalogue);
  REQUIRE(loaded);
  const DevicePoints points(*loaded.value, loaded.value->devices.at(1).name);
  REQUIRE(points.shares().size() == 2);
  const DeviceShare& inputs = points.shares().at(0);
  CHECK(inputs.station == 1);
  CHECK(inputs.direction == io::Direction::input);
  std::vector<std::string> expected;
  for (const io::Point& p : points.all())
    if (p.direction == io::Direction::input) expected.push_back(p.tag);
  std::vector<std::string> seen;
  for (const std::uint32_t place : inputs.places) seen.push_back(expected.at(place));
  std::vector<std::string> tags;
  for (const std::string& tag : inputs.tags) tags.push_back("robot." + tag);
  CHECK(seen == tags);
}

TEST_CASE("Inputs of another max_age travel in a link of their own (IMG-2)") {
  config::Configuration configuration;
  configuration.stations.resize(1);
  for (const std::int64_t age_ns : {50, 200, 50}) {
    config::TagMapping mapping;
    mapping.tag = "t" + std::to_string(configuration.stations[0].inputs.size());
    mapping.device = "io";
    mapping.max_age_ns = age_ns;
    configuration.stations[0].inputs.push_back(mapping);
  }
  const DevicePoints points(configuration, "io");
  REQUIRE(points.shares().size() == 2);
  CHECK(points.shares()[0].tags == std::vector<std::string>{"t0", "t2"});
  CHECK(points.shares()[0].places == std::vector<std::uint32_t>{0, 2});
  CHECK(points.shares()[1].stale_after_ns == 200);
  CHECK(points.shares()[1].places == std::vector<std::uint32_t>{1});
}

TEST_CASE("Shipped configurations name only programs and tags that there are (CFG-1)") {
  const config::ProgramCatalogue catalogue = program_catalogue();
  for (const char* name : {"controller1", "controller2", "cell-in-process"}) {
    CAPTURE(name);
    const auto loaded = config::load_controller(
        std::filesystem::path(STATIOND_SOURCE_DIR) / "config" / (std::string(name) + ".toml"), &catalogue);
    for (const config::Problem& p : loaded.problems) FAIL_CHECK(p.text);
    CHECK(loaded);
  }
}

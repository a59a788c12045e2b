// A station and a foreign peer: Cyclone DDS with the paper's literal types, in a process of its own.
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

#include "tests/bus_controller.hpp"

namespace stationd::bus::test {
namespace {

struct Result {
  int status = -1;
  std::string output;
  bool has(const std::string& line) const { return output.find(line) != std::string::npos; }
};

/// Runs the peer on loopback in the test's domain and cell.
Result peer(const std::string& arguments) {
  const std::string command =
      "CYCLONEDDS_URI='<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\" "
      "multicast=\"true\"/></Interfaces></General></Domain></CycloneDDS>' " STATIOND_CYCLONE_PEER " " +
      std::to_string(domain()) + " " + options("").cell + " " + arguments + " 2>&1";
  Result result;
  std::FILE* pipe = popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::array<char, 256> line{};
  while (std::fgets(line.data(), line.size(), pipe) != nullptr) result.output += line.data();
  result.status = WEXITSTATUS(pclose(pipe));
  return result;
}

TEST_CASE("cyclone peer when it listens then receives Set, End and GSE of a station [PV-5, ASE-4]") {
  Controller controller("robot");
  Desk desk;
  REQUIRE(desk.reaches());
  desk.start("notes=3 speed=205");
  REQUIRE(desk.sees(StationState::RUNNING));
  const Result got = peer("listen 3");
  CAPTURE(got.output);
  CHECK(got.status == 0);
  CHECK(got.has("Set robot 205\n"));
  CHECK(got.has("End robot 205 1 0\n"));
  CHECK(got.has("GSE 0 1301\n"));
}

TEST_CASE("cyclone peer when it announces then the station takes its Set as input [PV-5]") {
  Controller controller("robot");
  Desk desk;
  const Result said = peer("say loader 103 3");
  CAPTURE(said.output);
  CHECK(said.status == 0);
  CHECK(controller.scanned.loader_code == 103);
  CHECK(desk.sets.any([](const Set& m) { return m.STATION == "loader" && m.CODE == 103 && m.SEQ == 0; }));
  CHECK(desk.ends.any([](const End& m) { return m.STATION == "loader" && m.ERROR && m.STATUS == 4711; }));
}

TEST_CASE("cyclone peer when it orders Start and Stop then the station obeys [REQ-1]") {
  Controller controller("robot");
  Desk desk;
  REQUIRE(desk.sees(StationState::STOPPED));
  const Result start = peer("order Start robot speed=7");
  CAPTURE(start.output);
  CHECK(start.status == 0);
  CHECK(desk.sees(StationState::RUNNING));
  CHECK(desk.sets.any([](const Set&) { return true; }));
  const Result stop = peer("order Stop robot mode=immediate");
  CAPTURE(stop.output);
  CHECK(stop.status == 0);
  CHECK(desk.sees(StationState::STOPPED));
}

TEST_CASE("cyclone peer when it asks then gets the answer with its id [REQ-1]") {
  Controller controller("robot");
  Desk desk;
  REQUIRE(desk.sees(StationState::STOPPED));
  const Result status = peer("order Msg robot status");
  CAPTURE(status.output);
  CHECK(status.status == 0);
  CHECK(status.has("Msg_Res cyclone 0 0 0 id=77 station=robot state=STOPPED"));
  const Result wrong = peer("order Msg robot dance");
  CAPTURE(wrong.output);
  CHECK(wrong.has("Msg_Res cyclone 0 1 1307 id=77 dance"));
}

TEST_CASE("endpoints when announced then have the QoS of Table 2 for a foreign peer [PV-1, ASE-2, REQ-1]") {
  Controller controller("robot");
  const Result got = peer("qos 9");
  CAPTURE(got.output);
  CHECK(got.status == 0);
  // Fast DDS 2.9 does not announce the transport priority; bus_wire_test reads it back locally.
  CHECK(got.has(" partition=" + options("").cell + "\n"));
  for (const char* topic : {"Set PV_Set", "End PV_End", "Status PV_Status"}) {
    CHECK(got.has(std::string("writer ") + topic +
                  " best-effort volatile deadline=500ms lease=500ms budget=0ms"));
  }
  CHECK(got.has("writer GSE ASE_GSE reliable transient-local deadline=none lease=none budget=0ms"));
  CHECK(got.has("writer Msg_Res Msg_Res reliable volatile deadline=none lease=none budget=0ms"));
  CHECK(got.has("reader Status PV_Status best-effort volatile deadline=none lease=none budget=10ms"));
  for (const char* topic : {"Start", "Stop", "Msg_Req"}) {
    CHECK(got.has(std::string("reader ") + topic +
                  " Msg_Req reliable volatile deadline=none lease=none budget=0ms"));
  }
}

}  // namespace
}  // namespace stationd::bus::test

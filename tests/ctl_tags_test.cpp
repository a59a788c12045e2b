// stationctl get, force, unforce and set without a bus: command line, texts, table, JSON.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "ctl/arguments.hpp"
#include "ctl/output.hpp"
#include "ctl/tags_text.hpp"

using namespace stationd;
using namespace stationd::ctl;

namespace {

Arguments parse(const std::vector<std::string_view>& words) {
  return parse_arguments(words, [](const char*) -> const char* { return nullptr; });
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

constexpr const char* kTags =
    "tag=conveyor value=false quality=GOOD area=output type=BOOL forced=true\n"
    "tag=press_time value=800ms quality=GOOD area=internal type=TIME "
    "writable=true range=100ms..5s unit=of the press\n"
    "tag=speed value=101 quality=GOOD area=internal type=UINT range=1..1000\n"
    "next=speed";

}  // namespace

TEST_CASE("tag commands take the station, the tag and its value [IMG-3]") {
  const Arguments force = parse({"force", "robot", "offset", "-5", "--json"});
  CHECK(force.problem.empty());
  CHECK(force.command == Command::force);
  CHECK(force.station == "robot");
  CHECK(force.text == "offset -5");
  CHECK(force.json);
  CHECK(parse({"set", "robot", "gain", "-.5"}).text == "gain -.5");
  CHECK(parse({"unforce", "robot", "all"}).command == Command::unforce);
  CHECK(parse({"get", "robot"}).problem.empty());
  CHECK(parse({"get", "robot", "gain"}).text == "gain");
}

TEST_CASE("tag commands with words missing or too many say what they take [IMG-3, SYS-7]") {
  CHECK(parse({"force"}).problem == "STATION is missing");
  CHECK(parse({"force", "robot", "conveyor=1"}).problem ==
        "force takes a tag and its value behind the station, as in `stationctl force robot conveyor true`, "
        "not \"conveyor=1\"");
  CHECK(has(parse({"set", "robot", "a", "1", "2"}).problem, "`stationctl set robot step_timeout 5s`"));
  CHECK(has(parse({"unforce", "robot"}).problem, "unforce takes a tag, or `all`"));
  CHECK(has(parse({"get", "robot", "a", "b"}).problem, "get takes one tag"));
  CHECK(parse({"force", "robot", "", "1"}).problem == "an empty word");
  CHECK(has(parse({"force", "robot", "a", "--jsn"}).problem, "unknown option --jsn"));
}

TEST_CASE("answers to orders about tags are sentences for people [IMG-3, SYS-7]") {
  CHECK(change_text("tag=conveyor forced=true state=RUNNING") == "conveyor is forced to true");
  CHECK(change_text("tag=conveyor forced=true note=the output stays safe until the station runs "
                    "state=STOPPED") ==
        "conveyor is forced to true: the output stays safe until the station runs");
  CHECK(change_text("tag=conveyor unforced=1 state=RUNNING") == "conveyor is no longer forced");
  CHECK(change_text("tag=conveyor unforced=0 state=RUNNING") == "conveyor was not forced");
  CHECK(change_text("tag=all unforced=0 state=RUNNING") == "no tag was forced");
  CHECK(change_text("tag=all unforced=1 state=RUNNING") == "1 tag is no longer forced");
  CHECK(change_text("tag=all unforced=3 state=RUNNING") == "3 tags are no longer forced");
  CHECK(change_text("tag=t value=2s before=1s state=RUNNING") == "t is set to 2s; it was 1s");
  CHECK(change_text("of a newer release") == "of a newer release");
}

TEST_CASE("tags of a station are a table and JSON, with what is forced and what can be set [IMG-3, IMG-2]") {
  const TagRows piece = tag_rows(kTags);
  CHECK(piece.next == "speed");
  REQUIRE(piece.rows.size() == 3);
  const std::vector<std::string> table = tags_table(piece.rows);
  REQUIRE(table.size() == 4);
  CHECK(table[1].find("true") == table[0].find("FORCED TO"));
  CHECK(table[2].find("100ms..5s") == table[0].find("CAN BE SET"));
  CHECK_FALSE(has(table[3], "1..1000"));
  const std::string json = tags_json("robot", piece.rows);
  CHECK(json.starts_with(
      R"({"station":"robot","ok":true,"tags":[{"tag":"conveyor","value":"false","quality":"GOOD",)"
      R"("area":"output","type":"BOOL","forced":"true","writable":false,"range":null,"unit":null})"));
  CHECK(has(json, R"("forced":null,"writable":true,"range":"100ms..5s","unit":"of the press"})"));
}

TEST_CASE("list and watch show how many tags are forced [IMG-3]") {
  Stations stations;
  Seen& seen = stations["robot"];
  seen.status.STATION = "robot";
  seen.status.FORCED = 2;
  seen.receipt_ns = 1'000;
  CHECK(has(stations_table(stations, {}, 2'000, 0)[1], "forced 2; never started"));
  CHECK(station_line(seen, 2'000).ends_with(" forced 2; never started"));
  CHECK(has(station_json(seen, 2'000), R"("forced":2,)"));
  seen.status.STATE = 1;
  CHECK(station_line(seen, 2'000).ends_with(" forced 2"));
}

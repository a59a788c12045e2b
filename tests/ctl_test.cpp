// stationctl without a bus: command line, JSON, texts, tables.
#include <doctest/doctest.h>

#include <map>
#include <string>

#include "ctl/arguments.hpp"
#include "ctl/json.hpp"
#include "ctl/output.hpp"
#include "ctl/text.hpp"
#include "scan/clock.hpp"

using namespace stationd;
using namespace stationd::ctl;

namespace {

Arguments parse(const std::vector<std::string_view>& words,
                std::map<std::string, std::string> environment = {}) {
  return parse_arguments(words, [&](const char* name) -> const char* {
    const auto it = environment.find(name);
    return it == environment.end() ? nullptr : it->second.c_str();
  });
}

Stations two_stations() {
  Stations stations;
  for (const char* name : {"robot", "storage"}) {
    Seen& seen = stations[name];
    seen.status.STATION = name;
    seen.status.CONTROLLER = "controller1";
    seen.receipt_ns = 1'000;
  }
  stations["robot"].status.STATE = 3;
  stations["robot"].status.FAULT = 1205;
  stations["storage"].status.STATE = 1;
  stations["storage"].status.SCANS = 4711;
  stations["storage"].status.PERIOD_NS = 10'000'000;
  stations["storage"].status.LATENESS_P99_NS = 87'000;
  return stations;
}

}  // namespace

TEST_SUITE_BEGIN("stationctl command line");

TEST_CASE("options may stand before and behind the command") {
  const Arguments a =
      parse({"--domain", "7", "start", "--json", "robot", "speed=3", "--timeout=500ms", "type=T"});
  CHECK(a.problem.empty());
  CHECK(a.command == Command::start);
  CHECK(a.domain == 7);
  CHECK(a.json);
  CHECK(a.station == "robot");
  CHECK(a.text == "speed=3 type=T");
  CHECK(a.timeout_ns == 500'000'000);
}

TEST_CASE("the environment gives the defaults") {
  CHECK(parse({"list"}, {{"STATIOND_DOMAIN", "42"}}).domain == 42);
  CHECK(parse({"list", "--domain", "3"}, {{"STATIOND_DOMAIN", "42"}}).domain == 3);
  CHECK(parse({"list"}, {{"STATIOND_CELL", "paint"}}).cell == "paint");
  CHECK(parse({"list"}).domain == 0);
  CHECK(parse({"list"}, {{"STATIOND_DOMAIN", "many"}}).problem ==
        "$STATIOND_DOMAIN takes a number from 0 to 99, not \"many\"");
}

TEST_CASE("what follows msg STATION is text, dashes included") {
  const Arguments a = parse({"msg", "robot", "get", "--json", "-x"});
  CHECK(a.text == "get --json -x");
  CHECK_FALSE(a.json);
}

TEST_CASE("interfaces replace the default, all means every one") {
  CHECK(parse({"list"}).interfaces == std::vector<std::string>{"127.0.0.1"});
  CHECK(parse({"list", "--interface", "10.0.0.1", "--interface", "10.0.0.2"}).interfaces ==
        std::vector<std::string>{"10.0.0.1", "10.0.0.2"});
  CHECK(parse({"list", "--interface", "all"}).interfaces.empty());
}

TEST_CASE("each command takes what belongs to it") {
  CHECK(parse({"stop", "all", "--end-of-piece"}).end_of_piece);
  CHECK(parse({"events", "--follow", "--count", "3"}).count == 3);
  CHECK(parse({"watch", "--count=2", "robot"}).station == "robot");
  CHECK(parse({"--version"}).command == Command::version);
  CHECK(parse({"list", "--help"}).command == Command::help);
}

TEST_CASE("what is wrong is said, with a suggestion where one is near") {
  CHECK(parse({}).problem == "COMMAND is missing");
  CHECK(parse({"lst"}).problem.starts_with("unknown command \"lst\""));
  CHECK(parse({"lst"}).problem.find("list") != std::string::npos);
  CHECK(parse({"list", "--jsn"}).problem.find("--json") != std::string::npos);
  CHECK(parse({"start"}).problem == "STATION is missing");
  CHECK(parse({"start", "robot", "fast"}).problem ==
        "start takes KEY=VALUE behind the station, not \"fast\"");
  CHECK(parse({"msg", "robot"}).problem == "TEXT is missing, such as `status`");
  CHECK(parse({"describe"}).problem == "CODE is missing, such as ST1203");
  CHECK(parse({"list", "robot"}).problem == "one word too many: \"robot\"");
  CHECK(parse({"list", "--domain", "100"}).problem == "--domain takes a number from 0 to 99, not \"100\"");
  CHECK(parse({"list", "--timeout", "2"}).problem.starts_with("--timeout takes a duration"));
  CHECK(parse({"list", "--timeout"}).problem == "--timeout needs a value");
  CHECK(parse({"list", "--interface", "eth0"}).problem.starts_with("--interface takes an IPv4 address"));
  CHECK(parse({"list", "--count", "3"}).problem == "--count belongs to watch and events");
  CHECK(parse({"watch", "--count", "0"}).problem.starts_with("--count takes a number of at least 1"));
  CHECK(parse({"list", "--follow"}).problem == "--follow belongs to events");
  CHECK(parse({"start", "robot", "--end-of-piece"}).problem == "--end-of-piece belongs to stop");
  CHECK(parse({"list", "--json=yes"}).problem == "--json takes no value");
}

TEST_SUITE_END();

TEST_SUITE_BEGIN("stationctl output");

TEST_CASE("JSON strings are always valid") {
  CHECK(json_quoted("a\"b\\c\nd\x01") == R"("a\"b\\c\nd\u0001")");
  CHECK(json_quoted("Käfig") == "\"Käfig\"");
  CHECK(json_quoted("\xFF") == "\"\xEF\xBF\xBD\"");
  CHECK(json_quoted("\xED\xA0\x80") == "\"\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD\"");
  CHECK(json_quoted("\xC3") == "\"\xEF\xBF\xBD\"");
  CHECK(JsonObject().str() == "{}");
  CHECK(JsonObject().number("a", 1).flag("b", true).text("c", "x").raw("d", json_array({"1", "2"})).str() ==
        R"({"a":1,"b":true,"c":"x","d":[1,2]})");
}

TEST_CASE("a station's JSON has stable keys") {
  const std::string text = stations_json(two_stations(), 2'000);
  CHECK(text.starts_with(R"({"stations":[{"station":"robot","controller":"controller1","state":"FAULT")"));
  for (const char* part : {R"("fault":1205)", R"("fault_name":"scan made no progress")", R"("scans":4711)",
                           R"("deadline_misses":0)", R"("lateness_p99_ns":87000)", R"("age_ns":1000)"})
    CHECK_MESSAGE(text.find(part) != std::string::npos, part);
}

TEST_CASE("the table is aligned and fits") {
  const std::vector<std::string> lines = stations_table(two_stations(), 2'000, 0);
  REQUIRE(lines.size() == 3);
  CHECK(lines[0].find("STATE") == lines[1].find("FAULT"));
  CHECK(lines[1].find("ST1205 scan made no progress") != std::string::npos);
  CHECK(lines[2].find("10ms") != std::string::npos);
  for (std::size_t width = 1; width < 150; ++width)
    for (const std::string& line : stations_table(two_stations(), 2'000, width)) CHECK(line.size() <= width);
}

TEST_CASE("a station that went silent is away") {
  CHECK(stations_table(two_stations(), 5'000'000'000, 0)[2].find("away") != std::string::npos);
  CHECK(stations_json(two_stations(), 5'000'000'000).find(R"("away":true)") != std::string::npos);
}

TEST_CASE("errors tell what to look at") {
  Arguments arguments = parse({"start", "robbot"});
  CHECK(
      no_station_text(arguments, two_stations()).find("there are robot, storage; did you mean \"robot\"?") !=
      std::string::npos);
  CHECK(no_station_text(arguments, {}).find("check that a daemon runs") != std::string::npos);
  arguments.station = "robot";
  CHECK(no_answer_text(arguments, "did not answer", {})
            .starts_with("robot did not answer within 2s: nothing of"));
  Stations fresh = two_stations();
  fresh["robot"].receipt_ns = monotonic_ns();
  CHECK(no_answer_text(arguments, "did not answer", fresh).find("its Status says FAULT") !=
        std::string::npos);
}

TEST_CASE("texts from the network cannot move the cursor") {
  CHECK(printable("a\x1b[2Jb\nc") == "a?[2Jb?c");
  CHECK(printable("a\nb\x1b", true) == "a\nb?");
  bus::Gse gse;
  gse.STATION = "r\x1b";
  gse.TEXT = "\x07";
  CHECK(event_text(gse).find('\x1b') == std::string::npos);
  CHECK(event_text(gse).find('\x07') == std::string::npos);
}

TEST_SUITE_END();

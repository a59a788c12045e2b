// stationctl without a bus: command line, JSON, texts, tables.
#include <doctest/doctest.h>

#include <map>
#include <string>

#include "ctl/arguments.hpp"
#include "ctl/json.hpp"
#include "ctl/output.hpp"
#include "ctl/replies.hpp"
#include "ctl/stats_text.hpp"
#include "ctl/supervisor.hpp"
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

StationStats some_stats() {
  StationStats station;
  bus::ScanStats& s = station.stats;
  s.STATION = "robot";
  s.TASK = "main";
  s.TASK_STATIONS = 2;
  s.PERIOD_NS = 10'000'000;
  s.SCANS = 90'000;
  s.DEADLINE_MISSES = 7;
  s.SKIPPED = 5;
  s.MINUTE_SCANS = 6'000;
  s.MINUTE_DEADLINE_MISSES = 1;
  s.FIGURES[0][static_cast<std::size_t>(Figure::response)] = {90'000, 1'000,  2'000,        3'000,
                                                              40'000, 50'000, 1'500'000'000};
  return station;
}

}  // namespace

TEST_SUITE_BEGIN("stationctl command line");

TEST_CASE("controller without real-time rights is named once below the list, with the remedy [SCAN-8]") {
  Stations stations = two_stations();
  CHECK(rights_lines(stations).empty());
  for (auto& [name, seen] : stations) seen.status.REALTIME = "refused: SCHED_FIFO 80; granted: memory lock";
  const std::vector<std::string> lines = rights_lines(stations);
  REQUIRE(lines.size() == 1);
  CHECK(lines[0].starts_with("controller1: real-time rights refused: SCHED_FIFO 80"));
  CHECK(lines[0].find("CAP_SYS_NICE") != std::string::npos);
  for (auto& [name, seen] : stations) seen.status.REALTIME = "granted: SCHED_FIFO 80, memory lock";
  CHECK(rights_lines(stations).empty());
}

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
  CHECK(parse({"stop", "robot", "mode=end_of_piece"}).end_of_piece);
  CHECK(parse({"stop", "robot", "mode=immediate"}).problem.empty());
  CHECK_FALSE(parse({"stop", "robot", "mode=immediate"}).end_of_piece);
  CHECK(parse({"reset", "all"}).station == "all");
  CHECK(parse({"events", "--follow", "--count", "3"}).count == 3);
  CHECK(parse({"watch", "--count=2", "robot"}).station == "robot");
  const Arguments stats = parse({"stats", "robot", "--histogram", "--json"});
  CHECK(stats.command == Command::stats);
  CHECK(stats.station == "robot");
  CHECK(stats.histogram);
  CHECK(parse({"stats"}).problem.empty());
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
  CHECK(parse({"stop", "robot", "mode=gentle"}).problem.find("which is --end-of-piece") != std::string::npos);
  CHECK(parse({"stop", "robot", "gently"}).problem ==
        "stop takes --end-of-piece behind the station, not \"gently\"");
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
  CHECK(parse({"list", "--histogram"}).problem == "--histogram belongs to stats");
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
  const std::string text = stations_json(two_stations(), {}, 2'000);
  CHECK(text.starts_with(R"({"stations":[{"station":"robot","controller":"controller1","state":"FAULT")"));
  for (const char* part : {R"("fault":1205)", R"("fault_name":"scan made no progress")", R"("scans":4711)",
                           R"("deadline_misses":0)", R"("lateness_p99_ns":87000)", R"("age_ns":1000)"})
    CHECK_MESSAGE(text.find(part) != std::string::npos, part);
}

TEST_CASE("the table is aligned and fits") {
  const std::vector<std::string> lines = stations_table(two_stations(), {}, 2'000, 0);
  REQUIRE(lines.size() == 3);
  CHECK(lines[0].find("STATE") == lines[1].find("FAULT"));
  CHECK(lines[1].find("ST1205 scan made no progress") != std::string::npos);
  CHECK(lines[2].find("10ms") != std::string::npos);
  for (std::size_t width = 1; width < 150; ++width)
    for (const std::string& line : stations_table(two_stations(), {}, 2'000, width))
      CHECK(line.size() <= width);
}

TEST_CASE("a station that went silent is away") {
  CHECK(stations_table(two_stations(), {}, 5'000'000'000, 0)[2].find("away") != std::string::npos);
  CHECK(stations_json(two_stations(), {}, 5'000'000'000).find(R"("away":true)") != std::string::npos);
}

TEST_CASE("a narrow table keeps the fault and leaves out what matters less [SYS-7]") {
  const std::vector<std::string> lines = stations_table(two_stations(), {}, 2'000, 60);
  CHECK(lines[0].find("FAULT OR WARNING") != std::string::npos);
  CHECK(lines[0].find("PERIOD") == std::string::npos);
  CHECK(lines[1].find("ST1205 scan made no progress") != std::string::npos);
}

TEST_CASE("a line of watch has the fault's code, and the age of what has gone silent [SYS-7]") {
  const Stations stations = two_stations();
  CHECK(station_line(stations.at("robot"), 2'000).find(" fault=ST1205 ") != std::string::npos);
  CHECK(station_line(stations.at("storage"), 2'000).find(" fault=none") != std::string::npos);
  const std::string away = station_line(stations.at("storage"), 3'000'001'000);
  CHECK(away.find("storage away: no Status for 3.0s; it was RUNNING") != std::string::npos);
}

TEST_CASE("stations that the supervisor misses are told from its answer [SYS-7]") {
  const std::vector<Missing> missing = missing_of(
      "station=storage state=RUNNING configured=true intent=run step=to shelf age=50.0ms pieces=1\n"
      "station=robot state=away configured=true intent=run controller=controller1 age=12.5s pieces=2\n"
      "station=sealer state=away configured=true intent=run pieces=0\n"
      "station=old state=away configured=false intent=run pieces=7",
      20'000'000'000);
  REQUIRE(missing.size() == 2);
  CHECK(missing[0].station == "robot");
  CHECK(missing[0].controller == "controller1");
  CHECK(missing[0].seen_ns == 7'500'000'000);
  CHECK(missing[1].station == "sealer");
  CHECK_FALSE(missing[1].seen_ns.has_value());
  CHECK(missing_of("no answer of pairs", 0).empty());
  const std::vector<std::string> lines = stations_table({}, missing, 21'000'000'000, 0);
  REQUIRE(lines.size() == 3);
  CHECK(lines[1].find("no Status for 13.5s, says the supervisor") != std::string::npos);
  CHECK(lines[2].find("not seen") != std::string::npos);
  CHECK(stations_json({}, missing, 21'000'000'000) ==
        R"({"stations":[],"missing":[{"station":"robot","controller":"controller1","age_ns":13500000000},)"
        R"({"station":"sealer","controller":"","age_ns":null}]})");
}

TEST_CASE("a reply's pairs are values in JSON, blanks in them included [SYS-7]") {
  const auto values = [](std::string_view body) {
    JsonObject out;
    add_values(out, body);
    return out.str();
  };
  CHECK(values("state=RUNNING step=wait for a pallet piece=0") ==
        R"({"values":{"state":"RUNNING","step":"wait for a pallet","piece":"0"}})");
  CHECK(values("done state=STOPPED") == R"({"values":{"state":"STOPPED"}})");
  CHECK(values("speed=3\ndelay=1s") == R"({"values":{"speed":"3","delay":"1s"}})");
  CHECK(values("station=a pieces=1\nstation=b pieces=2") ==
        R"({"rows":[{"station":"a","pieces":"1"},{"station":"b","pieces":"2"}]})");
  CHECK(values("ST1203 real-time rights refused. Set x=1") == "{}");
  CHECK(values("") == "{}");
}

TEST_CASE("a refusal has the code's name and remedy, a fault its cause too [SYS-7]") {
  bus::MsgRes reply;
  reply.ERROR = true;
  reply.STATUS = 1303;
  reply.BODY = "id=5 refused: ST1303 (fault still present) state=FAULT";
  CHECK(refusal_text(reply) ==
        "ST1303 (fault still present) state=FAULT. Remedy: Remove the cause, then reset again.");
  reply.BODY = "id=5";
  CHECK(refusal_text(reply) == "ST1303 fault still present. Remedy: Remove the cause, then reset again.");
  bus::Status status = two_stations().at("robot").status;
  CHECK(fault_text(status) ==
        "it is in FAULT: ST1205 scan made no progress. Cause: The station's scan did not finish within its "
        "watchdog time. Remedy: Its outputs were made safe. Find the program's loop; then reset, then Start. "
        "Then: stationctl reset robot");
  status.FAULT = 9999;
  CHECK(fault_text(status).find("stationctl msg robot describe ST9999") != std::string::npos);
}

TEST_CASE("an event's JSON has its source and a time with offset [SYS-7]") {
  bus::Gse gse;
  gse.STATUS = 1101;
  gse.TEXT = "field device lost: remote-io-1";
  gse.SOURCE_TIME = 1'767'225'600'250'000'000;
  const std::string json = event_json(gse);
  CHECK(json.find(R"("source":"remote-io-1")") != std::string::npos);
  CHECK(json.find(R"("time":"20)") != std::string::npos);
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

TEST_CASE("durations with three digits") {
  CHECK(precise_duration(0) == "0ns");
  CHECK(precise_duration(999) == "999ns");
  CHECK(precise_duration(1'000) == "1.00us");
  CHECK(precise_duration(12'345) == "12.3us");
  CHECK(precise_duration(99'960) == "100us");
  CHECK(precise_duration(999'400) == "999us");
  CHECK(precise_duration(999'600) == "1.00ms");
  CHECK(precise_duration(1'501'000'000) == "1.50s");
  CHECK(precise_duration(274'877'906'944) == "275s");
}

TEST_CASE("statistics show both windows, aligned, and the task's figures where they differ [SCAN-6]") {
  const StationStats station = some_stats();
  const std::vector<std::string> lines = stats_lines(station);
  REQUIRE(lines.size() == 1 + 2 * (2 + kFigures));
  CHECK(lines[0] == "robot: task main, 2 stations, every 10ms");
  CHECK(lines[1] == "  last minute: 6000 scans, 1 deadline miss, of them 0 cycles skipped");
  CHECK(lines[13] == "  since start: 90000 scans, 7 deadline misses, of them 5 cycles skipped");
  const std::string& heading = lines[14];
  const std::string& response = lines[17];
  CHECK(response.starts_with("    response"));
  for (const auto& cell : std::map<std::string, std::string>{
           {"min", "1.00us"}, {"mean", "2.00us"}, {"p50", "3.00us"}, {"p99", "40.0us"}, {"max", "1.50s"}}) {
    const auto& column = cell.first;
    const auto& value = cell.second;
    CAPTURE(column);
    const std::size_t end = heading.find(column + (column == "max" ? "" : " ")) + column.size();
    CHECK(response.substr(end - value.size(), value.size()) == value);
  }
  CHECK(lines[3].find(" -") != std::string::npos);  // nothing recorded in the last minute
  StationStats alone = station;
  alone.stats.TASK_STATIONS = 1;
  CHECK(stats_lines(alone).size() == lines.size() - 4);
}

TEST_CASE("statistics as JSON have stable keys [SCAN-6]") {
  StationStats station = some_stats();
  const std::string text = stats_json({station});
  CHECK(text.starts_with(R"({"stations":[{"station":"robot","task":"main","task_stations":2,)"
                         R"("period_ns":10000000,"source_time_ns":0,"since_start":{"scans":90000,)"
                         R"("deadline_misses":7,"skipped":5,"lateness":{"count":0,)"));
  CHECK(text.find(R"("response":{"count":90000,"min_ns":1000,"mean_ns":2000,"p50_ns":3000,"p99_ns":40000,)"
                  R"("p999_ns":50000,"max_ns":1500000000})") != std::string::npos);
  CHECK(text.find(R"("last_minute":{"scans":6000,)") != std::string::npos);
  CHECK(text.find("histograms") == std::string::npos);
  station.histograms.push_back({Figure::response, Window::since_start, 1, {{3, 7}, {2'112, 1}}});
  CHECK(stats_json({station}).ends_with(R"("histograms":{"response":[{"from_ns":3,"to_ns":4,"count":7},)"
                                        R"({"from_ns":274877906944,"count":1}]}}]})"));
}

TEST_CASE("histogram's bars keep every count, show one in a million and end with the overflow [SCAN-6]") {
  bus::HistogramBody histogram{Figure::response, Window::since_start, 1, {}};
  for (const auto& [ns, count] : std::map<std::int64_t, std::uint64_t>{
           {150'000, 999'000}, {160'000, 998}, {1'100'000, 1}, {300'000'000'000, 1}})
    histogram.buckets.push_back({Buckets::index(ns), count});
  const std::vector<std::string> lines = histogram_lines(histogram);
  REQUIRE(lines.size() == 5);  // 100us, 200us, 500us, 1ms, the overflow
  CHECK(lines[0].starts_with(" 100us  to 200us   999998   99.999%"));
  CHECK(lines[0].ends_with(std::string(40, '#')));
  CHECK(lines[1].ends_with("0   99.999%"));  // never 100 % while something follows
  CHECK(lines[3].find("1.00ms  to 2.00ms       1") != std::string::npos);
  CHECK(lines[3].ends_with(" ###"));
  CHECK(lines[4].starts_with("  275s  or more"));
  CHECK(lines[4].find("100.000%") != std::string::npos);
  CHECK(histogram_lines({}).empty());
}

TEST_CASE("histogram of the whole range has a row for each of 1, 2, 5, 10 [SCAN-6]") {
  bus::HistogramBody histogram;
  for (std::size_t i = 0; i < Buckets::kCount; ++i) histogram.buckets.push_back({i, 1});
  const std::vector<std::string> lines = histogram_lines(histogram);
  CHECK(lines.size() == 2 + 3 * 11 + 2);  // 0, then 1 ns to 50 s, 100 s, 200 s, overflow
  CHECK(lines[0].find("0ns  to 1.00us") == std::string::npos);
  CHECK(lines[1].find("1ns  to 2ns") != std::string::npos);
  std::uint64_t total = 0;
  for (const std::string& line : lines) total += std::stoull(line.substr(line.find("  ", 12)));
  CHECK(total == Buckets::kCount);
}

TEST_SUITE_END();

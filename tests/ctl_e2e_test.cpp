// stationctl as a process, over real DDS on loopback, against fake stations: output and exit status of each
// command.
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>

#include "tests/supervisor_fake_cell.hpp"

using namespace stationd;
using stationd::testing::FakeCell;

namespace {

struct Result {
  int status = -1;
  std::string text;  ///< standard output and error
};

Result run(const std::string& arguments) {
  const std::string command = std::string(STATIONCTL) + " --domain " +
                              std::to_string(stationd::testing::test_domain()) + " " + arguments +
                              " 2>&1 </dev/null";
  Result result;
  FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::array<char, 4096> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    result.text.append(buffer.data(), n);
  const int status = ::pclose(pipe);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

/// Options for a machine that is busy.
constexpr const char* kPatient = "--timeout 30s ";

bool has(const Result& result, const std::string& part) {
  return result.text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("list shows every station, as a table and as JSON") {
  FakeCell cell({"robot", "loader"});
  const Result table = run(std::string(kPatient) + "list");
  CHECK(table.status == 0);
  CHECK(has(table, "robot "));
  CHECK(has(table, "never started"));
  const Result json = run(std::string(kPatient) + "--json list");
  CHECK(json.status == 0);
  CHECK(json.text.starts_with(R"({"stations":[{"station":"loader","controller":"fake","state":"STOPPED")"));
  CHECK(has(json, R"({"station":"robot")"));
}

TEST_CASE("start and stop wait for the confirmation") {
  FakeCell cell({"robot", "loader"});
  CHECK(run(std::string(kPatient) + "start robot").text == "robot RUNNING\n");
  CHECK(cell.runs("robot"));
  CHECK(run(std::string(kPatient) + "start robot").status == 0);
  const Result late = run(std::string(kPatient) + "start robot speed=3");
  CHECK(late.status == 1);
  CHECK(has(late, "RUNNING already"));
  CHECK(has(run(std::string(kPatient) + "stop robot --end-of-piece"), "STOPPING"));
  CHECK(run(std::string(kPatient) + "stop robot").text == "robot STOPPED\n");
  const Result all = run(std::string(kPatient) + "--json start all");
  CHECK(all.status == 0);
  CHECK(all.text.starts_with(R"({"command":"start","ok":true,"stations":[{"station":"loader","ok":true)"));
  CHECK(cell.all_run());
}

TEST_CASE("a station in FAULT refuses Start, with cause, remedy and the next step [SYS-7]") {
  FakeCell cell({"robot"});
  cell.with("robot", [](auto& s) {
    s.status.STATE = 3;
    s.status.FAULT = 1205;
  });
  const Result result = run(std::string(kPatient) + "start robot");
  CHECK(result.status == 1);
  CHECK(has(result, "robot refused Start: it is in FAULT: ST1205 scan made no progress. Cause: "));
  CHECK(has(result, "Remedy: "));
  CHECK(has(result, "stationctl reset robot"));
}

TEST_CASE("reset all acknowledges every fault, as start all and stop all do [SYS-7]") {
  FakeCell cell({"robot", "loader", "sealer"});
  CHECK(run(std::string(kPatient) + "reset all").text == "no station is in FAULT: nothing to reset\n");
  for (const char* name : {"robot", "loader"})
    cell.with(name, [](auto& s) {
      s.status.STATE = 3;
      s.status.FAULT = 1205;
    });
  const Result json = run(std::string(kPatient) + "--json reset all");
  CHECK(json.status == 0);
  CHECK(json.text.starts_with(R"({"command":"reset","ok":true,"stations":[{"station":"loader","ok":true)"));
  CHECK(has(json, R"({"station":"robot","ok":true)"));
  CHECK_FALSE(has(json, "sealer"));
  CHECK(cell.with("robot", [](auto& s) { return s.status.STATE; }) == 0);
  cell.with("robot", [](auto& s) { s.status.STATE = 3; });
  CHECK(run(std::string(kPatient) + "reset all").text == "robot reset\n");
}

TEST_CASE("list shows a station that the supervisor knows and that is not on the bus [SYS-7]") {
  FakeCell cell({"robot", "supervisor"});
  cell.with("supervisor", [](auto& s) {
    s.answer =
        "station=robot state=RUNNING configured=true\n"
        "station=sealer state=away controller=controller2 age=12.5s configured=true";
  });
  Result table;
  for (int i = 0; i < 5 && !has(table, "sealer"); ++i) table = run(std::string(kPatient) + "list");
  CHECK(table.status == 0);
  CHECK(has(table, "sealer "));
  CHECK(has(table, "says the supervisor"));
  CHECK_FALSE(has(table, "robot  away"));
}

TEST_CASE("watch goes on showing a station whose controller died, with the age of its Status [SYS-7]") {
  auto cell = std::make_unique<FakeCell>(std::vector<std::string>{"robot"});
  const std::string command = std::string(STATIONCTL) + " --domain " +
                              std::to_string(stationd::testing::test_domain()) +
                              " --timeout 30s watch --count 6 2>&1 </dev/null";
  FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::string text;
  std::array<char, 512> line{};
  while (std::fgets(line.data(), line.size(), pipe) != nullptr) {
    text += line.data();
    if (text.find("robot STOPPED") != std::string::npos) cell.reset();
  }
  CHECK(::pclose(pipe) == 0);
  CHECK(text.find("robot away: no Status for ") != std::string::npos);
}

TEST_CASE("a station that does not answer: one clear error within the time-out, status 2") {
  FakeCell cell({"robot"});
  cell.with("robot", [](auto& s) { s.deaf = true; });
  const Result order = run("--timeout 3s start robot");
  CHECK(order.status == 2);
  CHECK(
      has(order,
          "stationctl: robot did not confirm Start within 3s: it is on the bus and its Status says STOPPED"));
  const Result question = run("--timeout 3s msg robot status");
  CHECK(question.status == 2);
  CHECK(has(question, "stationctl: robot did not answer within 3s:"));
  const Result json = run("--timeout 3s --json msg robot status");
  CHECK(has(json, R"({"ok":false,"status":2,"message":"robot did not answer)"));
}

TEST_CASE("a station that is not there: status 3 and a suggestion") {
  FakeCell cell({"robot"});
  const Result misspelt = run("--timeout 3s start robbot");
  CHECK(misspelt.status == 3);
  CHECK(has(misspelt, "did you mean \"robot\"?"));
  CHECK(run("--timeout 3s msg robbot status").status == 3);
  const Result other = run("--timeout 500ms --cell elsewhere list");
  CHECK(other.status == 3);
  CHECK(has(other, "no station was seen within 500ms (cell elsewhere, domain "));
}

TEST_CASE("msg and reset print the answer, or the refusal with status 1") {
  FakeCell cell({"robot"});
  CHECK(run(std::string(kPatient) + "msg robot status").text == "fake status\n");
  CHECK(run(std::string(kPatient) + "reset robot").text == "fake reset\n");
  const Result refused = run(std::string(kPatient) + "msg robot dance");
  CHECK(refused.status == 1);
  CHECK(has(refused, "robot refused: not a verb (ST1307 unknown verb)"));
  CHECK(has(run(std::string(kPatient) + "--json msg robot status"),
            R"({"station":"robot","ok":true,"error":false,"status":0,"code":0,"body":"fake status"})"));
}

TEST_CASE("watch prints samples and ends after --count") {
  FakeCell cell({"robot"});
  const Result lines = run(std::string(kPatient) + "watch robot --count 2");
  CHECK(lines.status == 0);
  CHECK(std::ranges::count(lines.text, '\n') == 3);
  CHECK(lines.text.starts_with("times are local: "));
  CHECK(has(lines, "robot STOPPED"));
  CHECK(run(std::string(kPatient) + "--json watch --count 1")
            .text.starts_with(R"({"stations":[{"station":"robot")"));
}

TEST_CASE("stats shows each station's statistics, its histograms when asked [SCAN-6]") {
  FakeCell cell({"robot", "loader"});
  for (const char* name : {"robot", "loader"}) cell.with(name, [](auto& s) { s.stats = true; });
  const Result one = run(std::string(kPatient) + "stats robot");
  CHECK(one.status == 0);
  CHECK(one.text.starts_with("robot: task fake, 1 station, every 10ms\n"));
  CHECK_FALSE(has(one, "loader"));
  const Result all = run(std::string(kPatient) + "--json stats --histogram");
  CHECK(all.status == 0);
  CHECK(all.text.starts_with(R"({"stations":[{"station":"loader","task":"fake")"));
  CHECK(has(all, R"({"station":"robot")"));
  CHECK(has(all, R"("histograms":{"lateness":[{"from_ns":1703936,"to_ns":1720320,"count":5}])"));
  CHECK(run("--timeout 3s stats robbot").status == 3);
}

TEST_CASE("stats of a station that publishes none: status 2, the others are shown [SCAN-6]") {
  FakeCell cell({"robot", "loader"});
  cell.with("loader", [](auto& s) { s.stats = true; });
  const Result none = run("--timeout 3s stats robot");
  CHECK(none.status == 2);
  CHECK(has(none, "stationctl: robot published no statistics within 3s:"));
  const Result some = run("--timeout 3s stats");
  CHECK(some.status == 2);
  CHECK(has(some, "loader: task fake"));
  CHECK(has(some, "stationctl: robot published no statistics"));
}

TEST_CASE("events lists what was reported before, each once") {
  FakeCell cell({"robot"});
  cell.raise("robot", 1101, 1);
  cell.raise("robot", 1101, 1);
  cell.raise("robot", 1205, 2);
  const Result all = run(std::string(kPatient) + "--json events --follow --count 2");
  CHECK(all.status == 0);
  CHECK(std::ranges::count(all.text, '\n') == 2);
  CHECK(has(all, R"("seq":1,"code":1101,"name":"field device lost","severity":"warning")"));
  CHECK(has(all, R"("seq":2,"code":1205)"));
}

TEST_CASE("events without any says so, and not among the JSON [SYS-7]") {
  FakeCell cell({"robot"});
  const Result none = run(std::string(kPatient) + "events");
  CHECK(none.status == 0);
  CHECK(none.text == "no events\n");
}

TEST_CASE("describe and usage need no bus") {
  CHECK(has(run("describe ST1203"), "ST1203 real-time rights refused (warning)\nCause:"));
  CHECK(run("describe 99999999").status == 1);
  CHECK(run("describe banana").status == 64);
  CHECK(run("frobnicate").status == 64);
  CHECK(run("help").status == 0);
}

TEST_CASE("no DDS network: status 69") {
  const Result result = run("--interface 203.0.113.77 list");
  CHECK(result.status == 69);
  CHECK(has(result, "203.0.113.77"));
}

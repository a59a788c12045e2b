// Controller and supervisor files: what is understood, and what is said about what is not.
#include <cstdlib>

#include <doctest/doctest.h>

#include "tests/config_fixture.hpp"

namespace stationd::config {
namespace {

/// The one problem of the good file with `from` replaced by `to`.
std::string problem_with(std::string_view from, std::string_view to) {
  const auto loaded = parse_controller(with(from, to), "c1.toml");
  REQUIRE_MESSAGE(loaded.problems.size() == 1, all_of(loaded.problems));
  CHECK(!loaded.value);
  return loaded.problems.front().text;
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

}  // namespace

TEST_CASE("controller file when good gives typed values and the documented defaults [CFG-1]") {
  setenv("STATE_DIRECTORY", "/run/here:/run/there", 1);
  const auto loaded = parse_controller(kGoodController, "c1.toml");
  unsetenv("STATE_DIRECTORY");
  REQUIRE_MESSAGE(loaded, all_of(loaded.problems));
  const Configuration& c = *loaded.value;
  CHECK(c.name == "c1");
  CHECK(c.bus.name == "c1");
  CHECK(c.state_dir == "/run/here");
  CHECK(!c.require_realtime);
  CHECK(c.bus.interfaces == std::vector<std::string>{"127.0.0.1"});
  CHECK(c.pv_heartbeat_ns == 100'000'000);
  CHECK(c.bus_bad_after_ns == 2'000'000'000);
  REQUIRE(c.tasks.size() == 1);
  CHECK(c.tasks[0].watchdog_ns == 100'000'000);
  CHECK(c.tasks[0].cpu == -1);
  REQUIRE(c.devices.size() == 1);
  CHECK(c.devices[0].port == 5020);
  CHECK(c.devices[0].stale_after_ns == 50'000'000);
  CHECK(c.devices[0].bad_after_ns == 500'000'000);
  REQUIRE(c.stations.size() == 1);
  CHECK(c.stations[0].task == "fast");
  REQUIRE(c.stations[0].inputs.size() == 2);
  CHECK(c.stations[0].inputs[0].point.tag == "press.part_present");
  CHECK(c.stations[0].inputs[0].max_age_ns == 50'000'000);
  CHECK(c.stations[0].inputs[1].point.type == TagType::UDINT);
  CHECK(c.stations[0].inputs[1].max_age_ns == 100'000'000);
  CHECK(c.stations[0].outputs[1].safe_given);
}

TEST_CASE("defaults of a device follow its period [CFG-1]") {
  const auto loaded = parse_controller(with("address =", "period = \"40ms\"\naddress ="), "c1.toml");
  REQUIRE(loaded);
  CHECK(loaded.value->devices[0].stale_after_ns == 200'000'000);
  CHECK(loaded.value->devices[0].bad_after_ns == 2'000'000'000);
}

TEST_CASE("misspelt key gets file, line, column and the key that was meant [CFG-1]") {
  CHECK(problem_with("period =", "peroid =") ==
        "c1.toml:6:1: task.fast.peroid: unknown key; did you mean \"period\"?");
  CHECK(contains(problem_with("[[task]]", "[bsu]\n[[task]]"),
                 "c1.toml:4:2: bsu: unknown section; did you mean \"bus\""));
  CHECK(contains(problem_with("safe = 5", "sfae = 5"), "station.press.outputs.pressure.sfae: unknown key"));
}

TEST_CASE("key that resembles none is answered with those that are allowed [CFG-2]") {
  const std::string text = problem_with("period =", "unheard_of = 1\nperiod =");
  CHECK(contains(text, "allowed in [[task]] are \"name\", \"period\""));
}

TEST_CASE("all errors of a file come at once, in its order [CFG-1]") {
  std::string text = with("period = \"10ms\"", "period = \"10\"\npriority = 99");
  text = with("127.0.0.1:5020", "plc.local:502", text);
  text = with("io-1:di:0", "io-2:di:0", text);
  text = with("program =", "upstream = \"press\"\nprogram =", text);
  const auto loaded = parse_controller(text, "c1.toml");
  REQUIRE_MESSAGE(loaded.problems.size() == 5, all_of(loaded.problems));
  for (std::size_t i = 1; i < 5; ++i)
    CHECK(loaded.problems[i - 1].position.line < loaded.problems[i].position.line);
  CHECK(contains(loaded.problems[0].text,
                 "c1.toml:6:10: task.fast.period: found the text \"10\"; not a duration"));
  CHECK(contains(loaded.problems[4].text, "did you mean \"io-1\"?"));
}

TEST_CASE("value out of its range says what was found and what is allowed [CFG-1]") {
  CHECK(contains(problem_with("\"10ms\"", "\"249us\""), "allowed is 250us to 1min"));
  CHECK(contains(problem_with("\"10ms\"", "\"61s\""), "allowed is 250us to 1min"));
  CHECK(contains(problem_with("\"10ms\"", "10"), "found the number 10; not a duration"));
  CHECK(contains(problem_with("\"10ms\"", "\"10ms\"\nwatchdog = \"9ms\""),
                 "watchdog: found the text \"9ms\"; allowed"));
  CHECK(
      contains(problem_with("\"10ms\"", "\"10ms\"\npriority = 0"), "allowed is a whole number from 1 to 95"));
  CHECK(contains(problem_with("\"10ms\"", "\"10ms\"\noverrun = \"skp\""), "did you mean \"skip\"?"));
  CHECK(contains(problem_with("[[task]]", "[bus]\ndomain = 100\n[[task]]"), "from 0 to 99"));
  CHECK(contains(problem_with("[[task]]", "[bus]\ninterfaces = [\"lo\"]\n[[task]]"),
                 "allowed are IPv4 addresses"));
  CHECK(contains(problem_with("[[task]]", "[bus]\nheartbeat = \"200ms\"\n[[task]]"),
                 "allowed is 1ms to 125ms"));
  CHECK(contains(problem_with("address =", "unit = 248\naddress ="), "from 1 to 247"));
  CHECK(contains(problem_with("address =", "stale_after = \"9ms\"\naddress ="), "stale_after: found"));
  CHECK(contains(problem_with("address =", "bad_after = \"50ms\"\naddress ="), "bad_after: found"));
  CHECK(contains(problem_with("\"c1\"", "\"c 1\""), "allowed are letters, digits, - and _"));
}

TEST_CASE("task slower than four publications within the deadline is refused [PV-2]") {
  CHECK(contains(problem_with("\"10ms\"", "\"126ms\""), "at most a quarter of bus.deadline, which is 500ms"));
}

TEST_CASE("missing section or key is named [CFG-1]") {
  const auto loaded = parse_controller("", "c1.toml");
  CHECK(loaded.problems.size() == 3);
  CHECK(contains(all_of(loaded.problems), "controller: missing"));
  CHECK(contains(problem_with("name = \"c1\"", ""), "controller.name: missing"));
  CHECK(contains(problem_with("program = \"presser\"", ""), "station.press.program: missing"));
  CHECK(contains(problem_with("address = \"127.0.0.1:5020\"", ""), "device.io-1.address: missing"));
}

TEST_CASE("environment variable may stand for a number, plain text may not [CFG-1]") {
  unsetenv("STATIOND_TEST_DOMAIN_X");
  const std::string text = with("[[task]]", "[bus]\ndomain = \"${STATIOND_TEST_DOMAIN_X:-7}\"\n[[task]]");
  CHECK(parse_controller(text, "c1.toml").value->bus.domain == 7);
  setenv("STATIOND_TEST_DOMAIN_X", "8", 1);
  CHECK(parse_controller(text, "c1.toml").value->bus.domain == 8);
  setenv("STATIOND_TEST_DOMAIN_X", "seven", 1);
  CHECK(contains(all_of(parse_controller(text, "c1.toml").problems), "found the text \"seven\""));
  unsetenv("STATIOND_TEST_DOMAIN_X");
  CHECK(contains(problem_with("[[task]]", "[bus]\ndomain = \"7\"\n[[task]]"), "allowed is a whole number"));
}

TEST_CASE("two of one name are refused [CFG-2]") {
  const std::string third = with("[[device]]", "[[task]]\nname = \"fast\"\n[[device]]");
  CHECK(contains(all_of(parse_controller(third, "f").problems),
                 "task.fast.name: found \"fast\" a second time"));
  const std::string second = "[[device]]\nname = \"io-1\"\naddress = \"127.0.0.1:5021\"\n[[station]]";
  CHECK(contains(all_of(parse_controller(with("[[station]]", second), "f").problems), "a second time"));
  const std::string same_unit = "[[device]]\nname = \"io-2\"\naddress = \"127.0.0.1:5020\"\n[[station]]";
  CHECK(contains(problem_with("[[station]]", same_unit), "one device per unit"));
}

TEST_CASE("two outputs on one place, and registers that overlap in part, are refused [CFG-2]") {
  CHECK(contains(problem_with("pressure =", "light = \"io-1:co:0\"\npressure ="),
                 "outputs.light.at: found io-1:co:0, which lies on station.press.outputs.press_down"));
  CHECK(contains(problem_with("force =", "torque = { at = \"io-1:ir:5\", type = \"UINT\" }\nforce ="),
                 "lies on"));
  CHECK(contains(problem_with("io-1:hr:10", "io-1:di:10"), "which can only be read"));
}

TEST_CASE("input on the place of an output or of another input reads it back [IO-1]") {
  CHECK(parse_controller(with("force =", "is_down = \"io-1:co:0\"\nforce ="), "f"));
  CHECK(parse_controller(with("force =", "again = \"io-1:di:0\"\nforce ="), "f"));
}

TEST_CASE("heartbeat has a register of its own and a period with a unit [IO-6]") {
  const auto loaded = parse_controller(with("address =", "heartbeat = { register = 11 }\naddress ="), "f");
  REQUIRE_MESSAGE(loaded, all_of(loaded.problems));
  CHECK(loaded.value->devices[0].heartbeat_period_ns == 100'000'000);
  CHECK(contains(problem_with("address =", "heartbeat = { register = 10 }\naddress ="),
                 "each register has one writer"));
  CHECK(contains(problem_with("address =", "heartbeat = { regster = 11, register = 12 }\naddress ="),
                 "did you mean"));
}

TEST_CASE("type that does not fit its table is refused [IO-1]") {
  CHECK(contains(problem_with("at = \"io-1:ir:4\"", "at = \"io-1:di:4\""), "allowed is BOOL in co and di"));
  CHECK(contains(problem_with("\"UDINT\"", "\"UDNIT\""), "did you mean \"UDINT\"?"));
}

TEST_CASE("file that is no TOML gives the place where it stops being one [CFG-1]") {
  const auto loaded = parse_controller("[controller]\nname = ", "c1.toml");
  REQUIRE(loaded.problems.size() == 1);
  CHECK(contains(loaded.problems[0].text, "c1.toml:2:"));
  CHECK(contains(loaded.problems[0].text, "syntax error: "));
}

TEST_CASE("file that cannot be read is a problem like any other [CFG-1]") {
  CHECK(contains(all_of(load_controller("/nonexistent/c1.toml").problems), "No such file"));
  CHECK(contains(all_of(load_controller("/").problems), "is a directory"));
}

TEST_CASE("supervisor file names stations, its journal and its state directory [CFG-1]") {
  const auto loaded = parse_supervisor(
      "[supervisor]\nstations = [\"b\", \"a\"]\nstate_dir = \"/tmp\"\n[bus]\ndomain = 3\n", "s.toml");
  REQUIRE_MESSAGE(loaded, all_of(loaded.problems));
  CHECK(loaded.value->stations == std::vector<std::string>{"b", "a"});
  CHECK(loaded.value->journal_file == "/tmp/supervisor.journal");
  CHECK(loaded.value->bus.name == "supervisor");
  CHECK(loaded.value->bus.domain == 3);
}

TEST_CASE("file of the other kind is one problem that names the right program [CFG-1]") {
  const std::string supervisor = "[bus]\ndomain = 1\n[supervisor]\nstations = [\"a\"]\nunknown = 1\n";
  CHECK(all_of(parse_controller(supervisor, "s.toml").problems) ==
        "s.toml:3:2: this is a supervisor's file; check it with stationd-supervisor --check s.toml, and run "
        "it with stationd-supervisor\n");
  CHECK(all_of(parse_supervisor(kGoodController, "c1.toml").problems) ==
        "c1.toml:2:2: this is a controller's file; check it with stationd --check c1.toml, and run it with "
        "stationd\n");
  CHECK(contains(all_of(parse_supervisor(supervisor + "[controller]\n", "s").problems), "unknown section"));
  CHECK(contains(all_of(parse_controller("[bus]\n", "c").problems), "controller: missing"));
}

TEST_CASE("supervisor file without stations or with one twice is refused [CFG-2]") {
  CHECK(contains(all_of(parse_supervisor("[supervisor]\n", "s").problems), "supervisor.stations: missing"));
  CHECK(contains(all_of(parse_supervisor("[supervisor]\nstations = [\"a\", \"a\"]\n", "s").problems),
                 "second time"));
  CHECK(contains(
      all_of(
          parse_supervisor("[bus]\nheartbeat = \"1ms\"\n[supervisor]\nstations = [\"a\"]\n", "s").problems),
      "only controllers have it"));
}

}  // namespace stationd::config

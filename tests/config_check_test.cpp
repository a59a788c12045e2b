// Stations held against what their programs declare.
#include <doctest/doctest.h>

#include "scan/error.hpp"
#include "tests/config_fixture.hpp"

namespace stationd::config {
namespace {

std::string problem_with(std::string_view from, std::string_view to) {
  const ProgramCatalogue catalogue = presser_catalogue();
  const auto loaded = parse_controller(with(from, to), "c1.toml", &catalogue);
  REQUIRE_MESSAGE(loaded.problems.size() == 1, all_of(loaded.problems));
  return loaded.problems.front().text;
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

}  // namespace

TEST_CASE("station that agrees with its program takes types, safe values and parameters from it [CFG-1]") {
  const ProgramCatalogue catalogue = presser_catalogue();
  const auto loaded = parse_controller(kGoodController, "c1.toml", &catalogue);
  REQUIRE_MESSAGE(loaded, all_of(loaded.problems));
  const StationConfig& station = loaded.value->stations[0];
  CHECK(station.outputs[0].point.safe_action == io::SafeAction::hold);
  CHECK(station.outputs[1].point.type == TagType::UINT);
  CHECK(station.outputs[1].point.safe_action == io::SafeAction::value);
  CHECK(station.outputs[1].point.safe_value == 5);
  CHECK(station.parameters[0].value == 800'000'000);
  CHECK(from_slot<float>(station.parameters[1].value) == doctest::Approx(2.5));
}

TEST_CASE("tag that the program does not know is named with the nearest one [CFG-1]") {
  const ProgramCatalogue catalogue = presser_catalogue();
  const auto loaded = parse_controller(with("part_present", "part_presnt"), "c1.toml", &catalogue);
  CHECK(contains(all_of(loaded.problems),
                 "c1.toml:14:1: station.press.inputs.part_presnt: the program \"presser\" has "
                 "no such tag; did you mean \"part_present\"?"));
  CHECK(contains(all_of(loaded.problems), "station.press.inputs: without a place in a device: part_present"));
}

TEST_CASE("program that there is not is answered with those that there are [CFG-1]") {
  CHECK(contains(problem_with("\"presser\"", "\"prester\""),
                 "there are presser, feeder; did you mean \"presser\"?"));
}

TEST_CASE("program that refuses its recipes becomes a problem of its station [CFG-1]") {
  ProgramCatalogue catalogue = presser_catalogue();
  catalogue.tags = [](const std::string&, const ProgramOptions&) -> ProgramTags {
    throw SetupError("recipe 1: no lid");
  };
  const auto loaded = parse_controller(kGoodController, "c1.toml", &catalogue);
  CHECK(all_of(loaded.problems) == "c1.toml:12:11: station.press.program: recipe 1: no lid\n");
  const std::string two =
      std::string(kGoodController) + "[[station]]\nname = \"second\"\nprogram = \"presser\"\n";
  CHECK(parse_controller(two, "c1.toml", &catalogue).problems.size() == 1);
}

TEST_CASE("tag of another area or type than the program's is refused [CFG-1]") {
  CHECK(contains(problem_with("type = \"UDINT\"", "type = \"UINT\""),
                 "found UINT; the program declares UDINT"));
  CHECK(contains(problem_with("\"io-1:co:0\"", "\"io-1:hr:0\""), "for a tag of type BOOL"));
  CHECK(
      contains(problem_with("part_present =", "press_time = \"io-1:di:7\"\npart_present ="), "internal tag"));
  CHECK(contains(problem_with("part_present =", "\"ready.code\" = \"io-1:ir:7\"\npart_present ="),
                 "from the bus"));
}

TEST_CASE("type of the program decides which registers overlap [CFG-2]") {
  std::string text = with(", type = \"UDINT\"", "");
  text +=
      "[[station]]\nname = \"other\"\nprogram = \"presser\"\n[station.inputs]\npart_present = \"io-1:di:1\"\n"
      "force = \"io-1:ir:5\"\n[station.outputs]\npress_down = \"io-1:co:1\"\npressure = \"io-1:hr:11\"\n";
  const ProgramCatalogue catalogue = presser_catalogue();
  const auto loaded = parse_controller(text, "c1.toml", &catalogue);
  REQUIRE_MESSAGE(loaded.problems.size() == 1, all_of(loaded.problems));
  CHECK(contains(loaded.problems[0].text,
                 "station.other.inputs.force.at: found io-1:ir:5, which lies on "
                 "station.press.inputs.force (io-1:ir:4, UDINT)"));
}

TEST_CASE("parameter out of the program's range is refused with the range [CFG-1]") {
  CHECK(contains(problem_with("\"800ms\"", "\"50ms\""), "found \"50ms\"; allowed is \"100ms\" to \"5s\""));
  CHECK(contains(problem_with("\"800ms\"", "800"), "found 800; allowed is"));
  CHECK(contains(problem_with("limit =", "limits ="), "no such parameter; did you mean \"limit\"?"));
  CHECK(contains(problem_with("2.5", "true"), "found true; allowed is"));
}

TEST_CASE(
    "parameter when writable then has the limits of the file, else those of the program [IMG-3, CFG-1]") {
  const ProgramCatalogue catalogue = presser_catalogue();
  const auto parameter = [&](std::string_view text) {
    const auto loaded = parse_controller(with("\"800ms\"", text), "c1.toml", &catalogue);
    REQUIRE_MESSAGE(loaded, all_of(loaded.problems));
    return loaded.value->stations[0].parameters[0];
  };
  const ParameterConfig plain = parameter("\"800ms\"");
  CHECK_FALSE(plain.writable);
  CHECK(plain.min == 100'000'000);
  CHECK(plain.max == 5'000'000'000);
  const ParameterConfig narrowed =
      parameter(R"({ type = "TIME", value = "800ms", min = "200ms", max = "1s", writable = true })");
  CHECK(narrowed.writable);
  CHECK(narrowed.value == 800'000'000);
  CHECK(narrowed.min == 200'000'000);
  CHECK(narrowed.max == 1'000'000'000);
  CHECK(parameter(R"({ value = "800ms", max = "1s" })").min == 100'000'000);
  const auto limit = parse_controller(with("2.5", "{ writable = true }"), "c1.toml", &catalogue);
  REQUIRE_MESSAGE(limit, all_of(limit.problems));
  CHECK(limit.value->stations[0].parameters[1].writable);
  CHECK(limit.value->stations[0].parameters[1].value == to_slot(0.0F));
}

TEST_CASE("limits that cannot be are refused with what is allowed [IMG-3, CFG-1]") {
  const auto problem = [](std::string_view text) { return problem_with("\"800ms\"", text); };
  CHECK(contains(problem(R"({ value = "800ms", min = "50ms" })"),
                 "press_time.min: found \"50ms\"; allowed is \"100ms\" to \"5s\""));
  CHECK(contains(problem(R"({ value = "800ms", max = "9s" })"), "press_time.max: found \"9s\""));
  CHECK(contains(problem(R"({ value = "800ms", min = "2s", max = "1s" })"),
                 "found \"2s\" to \"1s\"; the least value has to be below the greatest"));
  CHECK(contains(problem(R"({ value = "800ms", max = "500ms" })"),
                 "found \"800ms\"; allowed is \"100ms\" to \"500ms\""));
  CHECK(contains(problem(R"({ writable = true, min = "200ms" })"), "the program's own value, \"0s\""));
  CHECK(contains(problem(R"({ value = "800ms", writable = 1 })"), "press_time.writable: found"));
  CHECK(contains(problem("{ type = \"TIME\" }"), "value: missing"));
}

TEST_CASE("tag of the program's own when listed then is writable, any other is refused [IMG-3, CFG-1]") {
  const auto text = [](std::string_view line) {
    return with("limit = 2.5", "limit = 2.5\n[station.tags]\n" + std::string(line));
  };
  const ProgramCatalogue catalogue = presser_catalogue();
  const auto loaded = parse_controller(
      text("pieces = { writable = true, max = 999 }\ndry_run = { writable = true }"), "c1.toml", &catalogue);
  REQUIRE_MESSAGE(loaded, all_of(loaded.problems));
  const std::vector<ParameterConfig>& tags = loaded.value->stations[0].tags;
  REQUIRE(tags.size() == 2);
  CHECK(tags[0].writable);
  CHECK(tags[0].min == 0);
  CHECK(tags[0].max == 999);
  CHECK(tags[1].max == 0);
  const auto problem = [&](std::string_view line) {
    const auto bad = parse_controller(text(line), "c1.toml", &catalogue);
    REQUIRE_MESSAGE(bad.problems.size() == 1, all_of(bad.problems));
    return bad.problems.front().text;
  };
  CHECK(contains(problem("piece = { writable = true }"), "did you mean \"pieces\"?"));
  CHECK(contains(problem("pieces = { max = 9 }"), "writable: missing"));
  CHECK(contains(problem("pieces = { writable = false }"), "found false; allowed is true"));
  CHECK(contains(problem("press_down = { writable = true }"), "inputs and outputs can be forced"));
  CHECK(contains(problem("limit = { writable = true }"), "belongs into [station.parameters]"));
  CHECK(contains(problem("dry_run = { writable = true, max = true }"), "found a limit of a BOOL"));
  CHECK(contains(problem("pieces = { writable = true, max = -1 }"), "found -1; allowed is 0 to 4294967295"));
}

TEST_CASE("safe value outside the output's type is refused [IO-6]") {
  CHECK(contains(problem_with("safe = 5", "safe = 65536"), "allowed is \"hold\", or 0 to 65535"));
  CHECK(contains(problem_with("safe = 5", "safe = \"halt\""), "found \"halt\""));
  CHECK(contains(problem_with("safe = 5", "safe = [1]"), "found a list"));
}

TEST_CASE("value wider than what is left of the table is refused [IO-1]") {
  CHECK(contains(problem_with("io-1:ir:4", "io-1:ir:65535"), "does not fit behind the last address"));
}

}  // namespace stationd::config

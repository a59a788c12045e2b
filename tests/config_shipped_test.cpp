// The shipped files: they load, agree with the wiring list, and survive being damaged at random.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>
#include <sstream>

#include <doctest/doctest.h>

#include "config/config.hpp"
#include "config/keys.hpp"
#include "tests/config_fixture.hpp"

namespace stationd::config {
namespace {

std::filesystem::path root() { return std::filesystem::path(STATIOND_SOURCE_DIR); }

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  REQUIRE_MESSAGE(in.good(), file.string());
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// All tags that docs/cell.md's tables name, as far as they are a station's.
std::set<std::string> wired_tags(const std::string& station) {
  static const std::set<std::string> stations = {"loader", "robot", "sealer", "storage"};
  std::set<std::string> tags;
  std::istringstream page(read(root() / "docs/cell.md"));
  for (std::string line; std::getline(page, line);) {
    const std::size_t second = line.find('|', 1);
    if (line.empty() || line[0] != '|' || second == std::string::npos || line[2] < '0' || line[2] > '9')
      continue;
    std::istringstream words(line.substr(second + 1, line.find('|', second + 1) - second - 1));
    std::string owner;
    for (std::string word; words >> word;) {
      if (word.back() == ',') word.pop_back();
      if (stations.count(word) != 0) owner = word;
      if (word.size() > 2 && word.front() == '`' && (owner.empty() || owner == station))
        tags.insert(word.substr(1, word.size() - 2));
    }
  }
  tags.erase("heartbeat");
  return tags;
}

std::set<std::string> mapped_tags(const StationConfig& station) {
  std::set<std::string> tags;
  for (const TagMapping& mapping : station.inputs) tags.insert(mapping.tag);
  for (const TagMapping& mapping : station.outputs) tags.insert(mapping.tag);
  return tags;
}

Configuration shipped(const char* name) {
  auto loaded = load_controller(root() / "config" / name);
  REQUIRE_MESSAGE(loaded, all_of(loaded.problems));
  return *std::move(loaded.value);
}

/// One random change: a byte, a piece cut out, a piece doubled, a piece of another place, a cut end.
std::string mutated(std::string text, std::mt19937& random) {
  const auto at = [&](std::size_t size) {
    return std::uniform_int_distribution<std::size_t>(0, size)(random);
  };
  static constexpr std::string_view alphabet = "[]{}=\"'#.,\n\\${}:-0aZ\x00\xff\xc3*_ ";
  const std::size_t from = at(text.size() - 1);
  const std::size_t length = std::min(at(30), text.size() - from);
  switch (at(4)) {
    case 0: text[from] = alphabet[at(alphabet.size() - 1)]; break;
    case 1: text.erase(from, length); break;
    case 2: text.insert(from, text.substr(from, length)); break;
    case 3: text.insert(at(text.size()), text.substr(from, length)); break;
    default: text.resize(from + 1); break;
  }
  return text;
}

void survive_mutations(const std::string& good, bool controller, unsigned seed) {
  const ProgramCatalogue catalogue = presser_catalogue();
  std::mt19937 random(seed);
  for (int i = 0; i < 3000; ++i) {
    std::string text = good;
    for (int changes = 1 + i % 4; changes > 0 && !text.empty(); --changes)
      text = mutated(std::move(text), random);
    const bool value =
        controller ? bool(parse_controller(text, "f", &catalogue)) : bool(parse_supervisor(text, "f"));
    const std::size_t problems = controller ? parse_controller(text, "f", &catalogue).problems.size()
                                            : parse_supervisor(text, "f").problems.size();
    REQUIRE(value == (problems == 0));
  }
}

}  // namespace

TEST_CASE("shipped controller files load and map exactly the tags of the wiring list [CFG-1]") {
  std::set<std::string> seen;
  for (const char* name : {"controller1.toml", "controller2.toml", "cell-in-process.toml"}) {
    const Configuration configuration = shipped(name);
    for (const StationConfig& station : configuration.stations) {
      CHECK_MESSAGE(mapped_tags(station) == wired_tags(station.name), station.name);
      seen.insert(station.name);
    }
    CHECK(configuration.recipes.size() == 3);
    CHECK(configuration.recipes[1].value("press_time", 0, 1'000'000'000) == 500'000'000);
  }
  CHECK(seen == std::set<std::string>{"loader", "robot", "sealer", "storage"});
}

TEST_CASE("shipped cell in process stands on the simulated plant, one unit per station [IO-5]") {
  const Configuration configuration = shipped("cell-in-process.toml");
  REQUIRE(configuration.devices.size() == 4);
  for (int i = 0; i < 4; ++i) {
    CHECK(configuration.devices[static_cast<std::size_t>(i)].kind == io::DeviceKind::simulated);
    CHECK(configuration.devices[static_cast<std::size_t>(i)].unit == i + 1);
  }
}

TEST_CASE("shipped supervisor file loads and starts all four stations [CFG-1]") {
  const auto loaded = load_supervisor(root() / "config/supervisor.toml");
  REQUIRE_MESSAGE(loaded, all_of(loaded.problems));
  CHECK(loaded.value->stations.size() == 4);
}

TEST_CASE("shipped files follow the environment [CFG-1]") {
  setenv("STATIOND_PLANT", "10.1.2.3:502", 1);
  setenv("STATIOND_PERIOD", "1ms", 1);
  const Configuration configuration = shipped("controller2.toml");
  unsetenv("STATIOND_PLANT");
  unsetenv("STATIOND_PERIOD");
  CHECK(configuration.devices[1].host == "10.1.2.3");
  CHECK(configuration.tasks[0].period_ns == 1'000'000);
  CHECK(configuration.devices[1].period_ns == 1'000'000);
}

TEST_CASE("reference page is what the key tables say [CFG-1]") {
  const std::filesystem::path page = root() / "docs/configuration.md";
  if (std::getenv("STATIOND_WRITE_DOCS") != nullptr) std::ofstream(page) << reference_markdown();
  CHECK_MESSAGE(read(page) == reference_markdown(), "run this test once with STATIOND_WRITE_DOCS=1");
}

TEST_CASE("damaged file never crashes and is either good or has problems [CFG-3]") {
  survive_mutations(std::string(kGoodController), true, 1);
  survive_mutations(read(root() / "config/controller1.toml").substr(0, 3000), true, 2);
  survive_mutations(read(root() / "config/supervisor.toml"), false, 3);
}

TEST_CASE("input known to end other parsers is a problem like any other [CFG-3]") {
  for (const std::string_view text :
       {"[*", "[[*", "a", "a=", "[", "\xef\xbb\xbf", "\xff\xfe", "a=[[[[[[", "a={", "\"\"", "a=1e999", "a=0x",
        "[a]\n[a]", "a.b=1\na=2", "[[task]]\n[task]", "device = 5", "station = [1, 2]",
        "[[station]]\ninputs = 1", "[controller]\nname = 1979-05-27"})
    CHECK_MESSAGE(!parse_controller(text, "f"), text);
  CHECK(!parse_controller("a=" + std::string(100'000, '['), "f"));
  CHECK(!parse_controller(std::string(100'000, 'a') + "=1", "f"));
  CHECK(!parse_controller(std::string("a = \"\0\"", 7), "f"));
}

}  // namespace stationd::config

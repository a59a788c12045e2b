// The supervisor's view, texts, saved state and command line: pure functions and a file.
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "dds_bridge/text.hpp"
#include "supervisor/arguments.hpp"
#include "supervisor/events.hpp"
#include "supervisor/live.hpp"
#include "supervisor/state.hpp"

using namespace stationd;
using namespace stationd::supervisor;

namespace {

constexpr std::int64_t ms = 1'000'000;

Model cell() {
  ModelOptions options;
  options.stations = {"storage", "robot"};
  Model model(options);
  bus::Status status;
  status.STATION = "storage";
  status.CONTROLLER = "controller2";
  status.STATE = 1;
  status.SCANS = 12345;
  status.DEADLINE_MISSES = 3;
  status.STEP_NAME = "to shelf";
  status.PIECE = 102;
  status.LATENESS_P99_NS = 87'000;
  status.LATENESS_MAX_NS = 1'340'000;
  model.on_status(status, 0);
  bus::End end;
  end.STATION = "storage";
  end.CODE = 101;
  end.EPOCH = 1;
  end.SEQ = 1;
  model.on_end(end, 0);
  bus::Gse gse;
  gse.STATION = "robot";
  gse.STATUS = 1101;
  gse.SEVERITY = 1;
  gse.ACTIVE = true;
  gse.EPOCH = 1;
  for (gse.SEQ = 1; gse.SEQ <= 15; ++gse.SEQ) model.on_gse(gse, 0);
  return model;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& line : lines) out += line + "\n";
  return out;
}

std::string view(const Model& model, std::size_t width, std::size_t height = 0,
                 std::int64_t now_ns = 1 * ms) {
  ViewOptions options;
  options.width = width;
  options.height = height;
  return joined(render(model, now_ns, options));
}

struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("stationd-supervisor-test-" + std::to_string(::getpid()));
  Folder() { std::filesystem::remove_all(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

SavedState some_state() {
  SavedState state;
  state["storage"].intent = Intent::stopped;
  state["storage"].pieces.counted = 7;
  state["storage"].pieces.missed = 1;
  state["storage"].pieces.faulty = 2;
  state["storage"].pieces.epochs = {{1, 5}, {2, 3}};
  state["robot"].intent = Intent::faulted;
  state["robot"].pieces.plain_code = 101;
  state["robot"].pieces.plain_error = true;
  return state;
}

}  // namespace

TEST_SUITE_BEGIN("supervisor view");

TEST_CASE("a wide view shows every column and the last ten events") {
  const std::string text = view(cell(), 160);
  for (const char* part :
       {"1 piece at storage", "1 of 2 running", "storage", "controller2", "RUNNING", "to shelf", "102",
        "12345", "87us/1.3ms", "not seen", "ST1101 field device lost", "Ctrl-C"})
    CHECK_MESSAGE(text.find(part) != std::string::npos, part);
  CHECK(std::ranges::count(text, '\n') == 2 + 3 + 1 + 1 + 10 + 2);
}

TEST_CASE("no line is wider than the terminal, and what matters most stays") {
  const Model model = cell();
  for (std::size_t width = 1; width < 170; ++width) {
    ViewOptions options;
    options.width = width;
    for (const std::string& line : render(model, 1 * ms, options)) CHECK(bus::columns_of(line) <= width);
  }
  const std::string narrow = view(model, 40);
  CHECK(narrow.find("storage") != std::string::npos);
  CHECK(narrow.find("RUNNING") != std::string::npos);
  CHECK(narrow.find("controller2") == std::string::npos);
}

TEST_CASE("no more lines than the terminal has") {
  const Model model = cell();
  for (std::size_t height = 1; height < 30; ++height) {
    const std::string text = view(model, 100, height);
    CHECK(static_cast<std::size_t>(std::ranges::count(text, '\n')) <= height);
  }
}

TEST_CASE("a station whose Status is old is away") {
  CHECK(view(cell(), 160, 0, 1500 * ms).find("away") != std::string::npos);
  CHECK(one_line(cell(), 1 * ms) == "1 piece | storage RUNNING | robot not seen");
}

TEST_CASE("color changes nothing but the paint") {
  ViewOptions plain;
  ViewOptions painted;
  painted.color = true;
  std::string text = joined(render(cell(), 1 * ms, painted));
  CHECK(text.find("\x1b[32mRUNNING") != std::string::npos);
  for (std::size_t at = text.find('\x1b'); at != std::string::npos; at = text.find('\x1b'))
    text.erase(at, text.find('m', at) - at + 1);
  CHECK(text == joined(render(cell(), 1 * ms, plain)));
}

TEST_CASE("names from the network cannot move the cursor") {
  Model model(ModelOptions{});
  bus::Status status;
  status.STATION = "evil\x1b[2J\n";
  status.CONTROLLER =
      "\xC2\x9B"
      "31m";
  model.on_status(status, 0);
  const std::string text = view(model, 160);
  CHECK(text.find('\x1b') == std::string::npos);
  CHECK(text.find("evil?[2J?") != std::string::npos);
  CHECK(text.find("\xC2\x9B") == std::string::npos);
}

TEST_CASE("the summary tells pieces, misses and lost events") {
  const std::string text = summary(cell(), 3'000 * ms, 0);
  CHECK(text.starts_with("1 piece counted at storage in 3.0s; 15 events, 0 lost\n"));
  CHECK(text.find("3 deadline misses in 12345 scans") != std::string::npos);
}

TEST_CASE("an event's line says how many were lost before it [ASE-2]") {
  EventRecord record;
  record.gse.STATION = "robot";
  record.gse.STATUS = 1101;
  record.gse.SEVERITY = 1;
  record.gse.SEQ = 4;
  record.gse.ACTIVE = true;
  CHECK(event_text(record) == "--:--:-- robot warning ST1101 field device lost");
  record.missing_before = 2;
  CHECK(event_text(record) == "--:--:-- robot warning ST1101 field device lost (2 lost before)");
}

TEST_SUITE_END();

TEST_SUITE_BEGIN("supervisor saved state");

TEST_CASE("what is encoded is decoded") {
  const std::optional<SavedState> back = decode(encode(some_state()));
  REQUIRE(back);
  CHECK(*back == some_state());
}

TEST_CASE("no shortened text passes for a whole one") {
  const std::string text = encode(some_state());
  for (std::size_t length = 0; length < text.size(); ++length) CHECK_FALSE(decode(text.substr(0, length)));
  CHECK_FALSE(decode(text + "more"));
}

TEST_CASE("a station that no word can name is left out") {
  SavedState state;
  state["two words"].intent = Intent::stopped;
  REQUIRE(decode(encode(state)));
  CHECK(decode(encode(state))->empty());
}

TEST_CASE("the file survives its writer and is never torn") {
  const Folder folder;
  const std::filesystem::path file = folder.path / "deep" / "supervisor.journal";
  std::string problem;
  {
    FileStateStore store(file);
    CHECK(store.load(problem).empty());
    CHECK(problem.empty());
    CHECK(store.save(some_state()).empty());
    CHECK_FALSE(std::filesystem::exists(file.string() + ".new"));
  }
  CHECK_FALSE(std::filesystem::exists(file.string() + ".lock"));
  FileStateStore again(file);
  CHECK(again.load(problem) == some_state());
}

TEST_CASE("a damaged file is kept aside and said") {
  const Folder folder;
  std::filesystem::create_directories(folder.path);
  const std::filesystem::path file = folder.path / "state";
  std::ofstream(file) << "stationd-supervisor 1\nintent stor";
  FileStateStore store(file);
  std::string problem;
  CHECK(store.load(problem).empty());
  CHECK(problem.find("kept aside") != std::string::npos);
  CHECK(std::filesystem::exists(file.string() + ".damaged"));
  CHECK_FALSE(std::filesystem::exists(file));
}

TEST_CASE("a second supervisor on the same file is refused") {
  const Folder folder;
  const FileStateStore first(folder.path / "state");
  CHECK_THROWS_AS(FileStateStore(folder.path / "state"), StateTaken);
}

TEST_CASE("a folder that cannot be made is one clear error with its remedy [SYS-7]") {
  std::string said;
  try {
    const FileStateStore store("/proc/nowhere/state");
  } catch (const SetupError& error) {
    said = error.what();
  }
  CHECK(said.starts_with("the state cannot be written: /proc/nowhere: "));
  CHECK(said.find("set [supervisor] state_dir or $STATE_DIRECTORY") != std::string::npos);
}

TEST_SUITE_END();

TEST_SUITE_BEGIN("supervisor command line");

TEST_CASE("all options") {
  const Arguments a = parse_arguments(
      {"--live", "cell.toml", "--observe", "--pieces", "20", "--name=panel", "--count-at", "sealer"});
  CHECK(a.problem.empty());
  CHECK(a.file == "cell.toml");
  CHECK_FALSE(a.check);
  CHECK(parse_arguments({"--check", "cell.toml"}).check);
  CHECK(a.live);
  CHECK(a.observe);
  CHECK(a.pieces == 20);
  CHECK(a.name == "panel");
  CHECK(a.count_at == "sealer");
}

TEST_CASE("what is wrong is said") {
  CHECK(parse_arguments({}).problem == "FILE is missing");
  CHECK(parse_arguments({"a", "b"}).problem == "one FILE only, not also b");
  CHECK(parse_arguments({"a", "--lively"}).problem == "unknown option --lively; did you mean \"--live\"?");
  CHECK(parse_arguments({"a", "--lively=3"}).problem.starts_with("unknown option --lively=3"));
  CHECK(parse_arguments({"a", "--pieces"}).problem == "--pieces needs a value");
  CHECK(parse_arguments({"a", "--pieces", "many"}).problem ==
        "--pieces needs a number of at least 1, not many");
  CHECK(parse_arguments({"a", "--pieces=0"}).problem.starts_with("--pieces needs a number"));
  CHECK(parse_arguments({"--help"}).problem.empty());
  CHECK(parse_arguments({"--version"}).problem.empty());
}

TEST_SUITE_END();

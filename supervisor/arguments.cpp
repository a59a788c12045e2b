#include "supervisor/arguments.hpp"

#include <array>
#include <charconv>

#include "config/units.hpp"

namespace stationd::supervisor {

const std::string_view kUsage =
    R"(usage: stationd-supervisor [OPTIONS] FILE
       stationd-supervisor --check FILE    check FILE, say every error in it

Starts the stations of a cell in the order that FILE (TOML) says, keeps them running, watches them and counts
pieces. What an operator stopped, or what faulted, it does not start again: an operator does
(stationctl start STATION).

One supervisor commands, others observe: at start it asks for a second whether another of its name commands
the cell; if so, it only observes until it is started again. Beside one of another name, use --observe.

  --live            show the cell in the terminal (without a terminal: one line for each change)
  --observe         order nothing and save nothing: a second screen beside the supervisor that commands
  --pieces N        end with a summary when N pieces have been counted (those of an earlier run with the
                    same state included)
  --count-at NAME   station whose End counts a piece (default: the first in the start order, the cell's last)
  --name NAME       name on the bus, in place of the one in FILE
  --help, --version

Exit status: 0 ended by --pieces, SIGINT or SIGTERM; 64 usage; 69 no DDS network, or another supervisor keeps
its state in the same file; 73 the state cannot be written; 78 errors in FILE.
)";

namespace {

std::string unknown_option(std::string_view word) {
  static constexpr auto known = std::to_array<std::string_view>(
      {"--check", "--live", "--observe", "--pieces", "--count-at", "--name", "--help", "--version"});
  return "unknown option " + std::string(word) + config::suggestion(word.substr(0, word.find('=')), known);
}

/// Takes the options that have a value; `used` says how many words were read.
bool take_valued(const std::vector<std::string_view>& words, std::size_t& at, Arguments& out) {
  std::string_view option = words[at];
  std::string_view value;
  const std::size_t equals = option.find('=');
  if (option != "--pieces" && option != "--count-at" && option != "--name" &&
      equals == std::string_view::npos)
    return false;
  if (equals != std::string_view::npos) {
    value = option.substr(equals + 1);
    option = option.substr(0, equals);
  } else if (at + 1 < words.size()) {
    value = words[++at];
  }
  if (option != "--pieces" && option != "--count-at" && option != "--name") return false;
  if (value.empty()) {
    out.problem = std::string(option) + " needs a value";
  } else if (option == "--pieces") {
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc{} || end != value.data() + value.size() || number == 0)
      out.problem = "--pieces needs a number of at least 1, not " + std::string(value);
    out.pieces = number;
  } else {
    (option == "--name" ? out.name : out.count_at) = value;
  }
  return true;
}

}  // namespace

Arguments parse_arguments(const std::vector<std::string_view>& words) {
  Arguments out;
  for (std::size_t at = 0; at < words.size() && out.problem.empty(); ++at) {
    const std::string_view word = words[at];
    if (word == "--check") {
      out.check = true;
    } else if (word == "--live") {
      out.live = true;
    } else if (word == "--observe") {
      out.observe = true;
    } else if (word == "--help" || word == "-h") {
      out.help = true;
    } else if (word == "--version") {
      out.version = true;
    } else if (word.starts_with("-")) {
      if (!take_valued(words, at, out)) out.problem = unknown_option(word);
    } else if (out.file.empty()) {
      out.file = word;
    } else {
      out.problem = "one FILE only, not also " + std::string(word);
    }
  }
  if (out.problem.empty() && out.file.empty() && !out.help && !out.version) out.problem = "FILE is missing";
  return out;
}

}  // namespace stationd::supervisor

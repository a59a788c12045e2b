#include "ctl/arguments.hpp"

#include <array>
#include <optional>
#include <span>
#include <utility>

#include "config/units.hpp"

namespace stationd::ctl {

const std::string_view kUsage =
    R"(usage: stationctl [OPTIONS] COMMAND

  list                          the stations that are on the bus now, and those that the supervisor misses
  watch [STATION] [--count N]   the same, again and again; --count ends after N samples
  start STATION|all [KEY=VALUE...]
                                starts a station (with parameters) and waits until its Status confirms it
  stop STATION|all [--end-of-piece]
                                stops at once, or when its piece is finished; waits for the confirmation
  msg STATION TEXT...           asks a station (or the supervisor) and prints its answer:
                                status, describe CODE, get TAG, tags, params, histogram FIGURE, ...;
                                supervisor: pieces, help
  get STATION [TAG]             its tags, or the one: value, quality, forced to what, whether it can be set
  force STATION TAG VALUE       holds an input or output at a value, whatever its device or program says,
                                until unforce or the daemon's restart; no output is driven outside RUNNING
  unforce STATION TAG|all       lets it go
  set STATION TAG VALUE         writes a tag that the configuration declares writable, such as a parameter
  reset STATION|all             acknowledges a fault whose cause is gone; all: of every station in FAULT
  describe CODE                 what a code means, its cause and remedy; needs no station
  events [--follow] [--count N] what the stations reported; --follow goes on, --count takes the last (next) N
  stats [STATION] [--histogram] how its scans keep their time: lateness, execution, response, each phase;
                                for the last minute and since start; --histogram draws the first three
  help                          this text

Options:
  --domain N        DDS domain, 0 to 99 (default: $STATIOND_DOMAIN, or 0)
  --cell NAME       name of the cell (default: $STATIOND_CELL, or assembly)
  --interface IP    this machine's IPv4 address to use; may be repeated; `all` for all (default: 127.0.0.1)
  --timeout T       how long to wait for an answer (default: 2s)
  --json            one JSON object; watch and events: one a line. msg: the pairs of the answer as `values`
                    (`rows` for several lines with the same keys)
  --version

Exit status: 0 done; 1 the station refused or answered with an error; 2 no answer within the time-out; 3 no
such station on the bus; 64 usage; 69 no DDS network.
)";

namespace {

using config::suggestion;

constexpr auto kCommands =
    std::to_array<std::pair<std::string_view, Command>>({{"help", Command::help},
                                                         {"list", Command::list},
                                                         {"watch", Command::watch},
                                                         {"start", Command::start},
                                                         {"stop", Command::stop},
                                                         {"msg", Command::msg},
                                                         {"reset", Command::reset},
                                                         {"get", Command::get},
                                                         {"force", Command::force},
                                                         {"unforce", Command::unforce},
                                                         {"set", Command::set},
                                                         {"describe", Command::describe},
                                                         {"events", Command::events},
                                                         {"stats", Command::stats}});
constexpr auto kOptions =
    std::to_array<std::string_view>({"--domain", "--cell", "--interface", "--timeout", "--json", "--version",
                                     "--help", "--count", "--follow", "--end-of-piece", "--histogram"});

class Parser {
 public:
  Parser(const std::vector<std::string_view>& words, Arguments& out) : words_(words), out_(out) {}

  void run() {
    while (at_ < words_.size() && out_.problem.empty()) {
      const std::string_view word = words_[at_++];
      const bool text_follows =
          !out_.station.empty() && (command_ == Command::msg || (takes_tag() && is_negative(word)));
      if (word.starts_with("-") && word.size() > 1 && !text_follows) {
        option(word);
      } else {
        plain(word);
      }
    }
    if (out_.problem.empty()) finish();
  }

 private:
  /// -5 and -.5, which are no options.
  static bool is_negative(std::string_view word) {
    return word.size() > 1 && word[0] == '-' && (word[1] == '.' || (word[1] >= '0' && word[1] <= '9'));
  }
  bool takes_tag() const {
    return command_ == Command::get || command_ == Command::force || command_ == Command::unforce ||
           command_ == Command::set;
  }

  void fail(std::string text) {
    if (out_.problem.empty()) out_.problem = std::move(text);
  }

  void option(std::string_view word) {
    const std::size_t equals = word.find('=');
    const std::string_view name = word.substr(0, equals);
    if (name == "--json") {
      out_.json = true;
    } else if (name == "--help" || name == "-h") {
      command_ = Command::help;
    } else if (name == "--version") {
      command_ = Command::version;
    } else if (name == "--follow") {
      out_.follow = true;
    } else if (name == "--histogram") {
      out_.histogram = true;
    } else if (name == "--end-of-piece") {
      out_.end_of_piece = true;
    } else if (name == "--domain" || name == "--cell" || name == "--interface" || name == "--timeout" ||
               name == "--count") {
      const bool inside = equals != std::string_view::npos;
      if (!inside && at_ == words_.size()) return fail(std::string(name) + " needs a value");
      valued(name, inside ? word.substr(equals + 1) : words_[at_++]);
      return;
    } else {
      return fail("unknown option " + std::string(word) + suggestion(name, kOptions));
    }
    if (equals != std::string_view::npos) fail(std::string(name) + " takes no value");
  }

  void valued(std::string_view name, std::string_view value) {
    const std::string said = ", not \"" + std::string(value) + "\"";
    if (name == "--domain") {
      domain(value, "--domain");
    } else if (name == "--cell") {
      if (value.empty()) fail("--cell needs a name");
      out_.cell = value;
    } else if (name == "--interface") {
      interface(value);
    } else if (name == "--timeout") {
      const std::optional<std::int64_t> ns = config::parse_duration_ns(value);
      if (!ns || *ns <= 0) return fail("--timeout takes a duration such as 2s or 500ms" + said);
      out_.timeout_ns = *ns;
    } else {
      const std::optional<std::int64_t> count = config::parse_integer(value);
      if (!count || *count < 1) return fail("--count takes a number of at least 1" + said);
      out_.count = static_cast<std::uint64_t>(*count);
    }
  }

  void interface(std::string_view value) {
    if (value != "all" && !config::is_ipv4(value))
      return fail("--interface takes an IPv4 address or `all`, not \"" + std::string(value) + "\"");
    if (!interface_given_ || value == "all") out_.interfaces.clear();
    if (value != "all") out_.interfaces.emplace_back(value);
    interface_given_ = true;
  }

 public:
  void domain(std::string_view value, std::string_view from) {
    const std::optional<std::int64_t> number = config::parse_integer(value);
    if (!number || *number < 0 || *number > 99)
      return fail(std::string(from) + " takes a number from 0 to 99, not \"" + std::string(value) + "\"");
    out_.domain = static_cast<int>(*number);
  }

 private:
  void plain(std::string_view word) {
    if (!command_) return command(word);
    const bool takes_text = *command_ == Command::msg || *command_ == Command::start || takes_tag();
    const bool takes_name =
        *command_ != Command::list && *command_ != Command::events && *command_ != Command::help;
    if (takes_name && out_.station.empty()) {
      if (word.empty()) return fail("an empty name");
      out_.station = word;
    } else if (*command_ == Command::stop && word.starts_with("mode=")) {
      stop_mode(word);  // as the order's body says it
    } else if (*command_ == Command::stop) {
      fail("stop takes --end-of-piece behind the station, not \"" + std::string(word) + "\"");
    } else if (takes_text && !out_.station.empty()) {
      if (*command_ == Command::start && word.find('=') == std::string_view::npos)
        return fail("start takes KEY=VALUE behind the station, not \"" + std::string(word) + "\"");
      if (takes_tag() && word.empty()) return fail("an empty word");
      out_.text += (out_.text.empty() ? "" : " ") + std::string(word);
      ++text_words_;
    } else if (*command_ != Command::help) {
      fail("one word too many: \"" + std::string(word) + "\"");
    }
  }

  void stop_mode(std::string_view word) {
    if (word != "mode=end_of_piece" && word != "mode=immediate")
      return fail(
          "stop takes mode=immediate (the default) or mode=end_of_piece, which is --end-of-piece; not \"" +
          std::string(word) + "\"");
    out_.end_of_piece = word == "mode=end_of_piece";
  }

  void command(std::string_view word) {
    std::vector<std::string_view> names;
    for (const auto& [name, which] : kCommands) {
      if (name == word) command_ = which;
      names.push_back(name);
    }
    if (!command_) fail("unknown command \"" + std::string(word) + "\"" + suggestion(word, names));
  }

  /// STATION is there.
  void check_tag_words() {
    const std::string seen = ", not \"" + out_.text + "\"";
    const bool two = out_.command == Command::force || out_.command == Command::set;
    const std::string verb = out_.command == Command::force ? "force" : "set";
    if (two && text_words_ != 2)
      return fail(verb + " takes a tag and its value behind the station, as in `stationctl " + verb +
                  (verb == "set" ? " robot step_timeout 5s`" : " robot conveyor true`") + seen);
    if (out_.command == Command::unforce && text_words_ != 1)
      return fail("unforce takes a tag, or `all`, behind the station" + seen);
    if (out_.command == Command::get && text_words_ > 1)
      return fail("get takes one tag behind the station" + seen);
  }

  void finish() {
    if (!command_) return fail("COMMAND is missing");
    out_.command = *command_;
    const bool needs_name = out_.command == Command::start || out_.command == Command::stop ||
                            out_.command == Command::msg || out_.command == Command::reset || takes_tag();
    if (needs_name && out_.station.empty()) return fail("STATION is missing");
    if (takes_tag()) check_tag_words();
    if (out_.command == Command::describe && out_.station.empty())
      return fail("CODE is missing, such as ST1203");
    if (out_.command == Command::msg && out_.text.empty()) return fail("TEXT is missing, such as `status`");
    if (out_.count && out_.command != Command::watch && out_.command != Command::events)
      return fail("--count belongs to watch and events");
    if (out_.follow && out_.command != Command::events) return fail("--follow belongs to events");
    if (out_.histogram && out_.command != Command::stats) return fail("--histogram belongs to stats");
    if (out_.end_of_piece && out_.command != Command::stop) return fail("--end-of-piece belongs to stop");
  }

  const std::vector<std::string_view>& words_;
  Arguments& out_;
  std::size_t at_ = 0;
  std::optional<Command> command_;
  std::size_t text_words_ = 0;
  bool interface_given_ = false;
};

}  // namespace

Arguments parse_arguments(const std::vector<std::string_view>& words, const Environment& environment) {
  Arguments out;
  Parser parser(words, out);
  if (const char* cell = environment("STATIOND_CELL"); cell != nullptr && *cell != '\0') out.cell = cell;
  const char* domain = environment("STATIOND_DOMAIN");
  if (domain != nullptr && *domain != '\0') parser.domain(domain, "$STATIOND_DOMAIN");
  parser.run();
  return out;
}

}  // namespace stationd::ctl

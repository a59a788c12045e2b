// Arguments: stationctl's command line as one value.
// Owned by main().
// Start-up only.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stationd::ctl {

enum class Command : std::uint8_t {
  help,
  version,
  list,
  watch,
  start,
  stop,
  msg,
  reset,
  get,
  force,
  unforce,
  set,
  describe,
  events,
  stats
};

struct Arguments {
  int domain = 0;
  std::string cell = "assembly";
  std::vector<std::string> interfaces = {"127.0.0.1"};  ///< empty: all
  std::int64_t timeout_ns = 2'000'000'000;
  bool json = false;
  Command command = Command::help;
  std::string station;                 ///< what the command is about; a code for describe; empty: all
  std::string text;                    ///< of msg; the key=value pairs of start; tag and value
  bool end_of_piece = false;           ///< stop
  bool follow = false;                 ///< events
  bool histogram = false;              ///< stats
  std::optional<std::uint64_t> count;  ///< watch, events
  std::string problem;                 ///< not empty: what is wrong with the command line
};

/// The value of an environment variable; null if it is not set.
using Environment = std::function<const char*(const char* name)>;

/// `words`: without the program's name. $STATIOND_DOMAIN and $STATIOND_CELL are the defaults.
Arguments parse_arguments(const std::vector<std::string_view>& words, const Environment& environment);

extern const std::string_view kUsage;

}  // namespace stationd::ctl

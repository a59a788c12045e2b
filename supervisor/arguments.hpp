// Arguments: the command line of stationd-supervisor as one value.
// Owned by main().
// Start-up only.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stationd::supervisor {

struct Arguments {
  std::string file;
  bool check = false;  ///< only check FILE
  bool live = false;
  bool observe = false;
  bool help = false;
  bool version = false;
  std::optional<std::uint64_t> pieces;  ///< end when so many have been counted
  std::string count_at;                 ///< whose End counts them; empty: the first in the start order
  std::string name;                     ///< in place of the configuration's; empty: that
  std::string problem;                  ///< not empty: what is wrong with the command line
};

/// `words`: without the program's name.
Arguments parse_arguments(const std::vector<std::string_view>& words);

extern const std::string_view kUsage;

}  // namespace stationd::supervisor

// Environment variables in strings: ${NAME} and ${NAME:-default}; $${ stands for a plain ${.
// Owned by nobody; pure but for getenv.
// Set-up only; one thread.
#pragma once

#include <string>
#include <string_view>

namespace stationd::config {

struct Expansion {
  std::string text;
  bool expanded = false;  ///< at least one ${...} was replaced
  std::string error;      ///< empty: none
};

Expansion expand_environment(std::string_view text);

}  // namespace stationd::config

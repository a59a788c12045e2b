// Syntax: says what is wrong with a file that is no TOML, and what was probably meant.
// Owned by nobody; a pure function.
// Set-up only; any thread.
#pragma once

#include <string>
#include <string_view>

#include "config/config.hpp"

namespace stationd::config {

/// "syntax error: WHAT; HINT (...)". `said`: the parser's own words; `at`: where it stopped in `file_text`.
std::string syntax_error_text(std::string_view file_text, Position at, std::string_view said);

}  // namespace stationd::config

// Reading numbers and durations from a command line.
// No state.
// Any thread.
#pragma once

#include <cstdint>
#include <string_view>

namespace stationd::plant {

/// A decimal integer from `min` to `max`. Throws std::invalid_argument with `what`, what was found and what
/// is allowed.
std::int64_t parse_integer(std::string_view text, std::string_view what, std::int64_t min, std::int64_t max);

/// "500ms", "2s", "1.5s", "250us", "10ns", to nanoseconds. Throws std::invalid_argument as above.
std::int64_t parse_duration_ns(std::string_view text, std::string_view what);

/// A positive decimal number, "0.5". Throws std::invalid_argument as above.
double parse_positive(std::string_view text, std::string_view what, double max);

}  // namespace stationd::plant

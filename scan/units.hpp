// Units: durations and other quantities as people write them, "1.5ms", exactly, and back.
// Owned by nobody; pure functions.
// Any plain thread (they allocate); not for scan threads.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace stationd {

struct Unit {
  std::string_view name;
  std::int64_t factor;  ///< how many of the smallest
};

/// A decimal number and one of the units (the greatest stand first), exactly: nothing where the product is
/// not whole or too large. No sign; spaces may stand before the unit.
std::optional<std::int64_t> parse_with_unit(std::string_view text, std::span<const Unit> units);
/// In the largest unit that gives a whole number.
std::string with_unit(std::int64_t value, std::span<const Unit> units);

/// "250us", "10ms", "1.5s", "2min", "1h": whole nanoseconds.
std::optional<std::int64_t> parse_duration_ns(std::string_view text);
/// "10ms", "0s".
std::string duration_text(std::int64_t ns);

}  // namespace stationd

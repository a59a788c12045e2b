// Values: a tag's value as people write it in requests and replies, and back.
// Owned by the caller; no state of its own.
// Any plain thread (they allocate).
#pragma once

#include <string>
#include <string_view>

#include "scan/image.hpp"
#include "scan/value.hpp"

namespace stationd::bus {

struct ParsedValue {
  Slot slot = 0;
  std::string
      problem;  ///< why it is refused, for people; empty: it is of the tag's type and within its range
};

/// BOOL: true, false, 1, 0, on, off. Integers: decimal. REAL, LREAL: decimal, finite.
/// TIME: a number with its unit, "300ms", "1.5s", "2min" (ns us ms s min h). STRING: refused.
/// Range: the tag's, or its type's if it has none.
ParsedValue parse_value(const TagSpec& spec, std::string_view text);

/// "true", "-7", "0.25", "300ms".
std::string format_value(TagType type, Slot slot);

/// "0..65535", "100ms..10s"; empty for BOOL and STRING and for numbers without a range.
std::string format_range(const TagSpec& spec);

}  // namespace stationd::bus

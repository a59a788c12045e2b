// Text: how the supervisor writes numbers, codes and states for people.
// Owned by nobody (pure functions).
// Any plain thread (they allocate).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "supervisor/events.hpp"

namespace stationd::supervisor {

/// What came over the bus may be hostile: control characters become '?', so that no text moves the cursor.
std::string printable(std::string_view text);

/// Exactly `width` columns: padded with blanks, or cut with a '~' at its end. Counts UTF-8 code points.
std::string fit(std::string_view text, std::size_t width);
/// The same, at the right.
std::string fit_right(std::string_view text, std::size_t width);
/// At most `width` columns.
std::string cut(std::string_view text, std::size_t width);
std::size_t columns_of(std::string_view text);

/// "870ns", "12us", "1.3ms", "2.1s".
std::string duration_text(std::int64_t ns);

/// "ST1203".
std::string code_id(std::uint32_t code);
/// "ST1203 real-time rights refused"; a code that the table lacks: "ST9001"; 0: empty.
std::string code_text(std::uint32_t code);

/// STATE of a Status message: "RUNNING"; "STATE 7" for a number that no release knows.
std::string state_text(std::uint32_t state);

/// "14:03:59 robot fault ST2104 gripper holds an unknown part": one event in one line.
std::string event_text(const EventRecord& record);

/// Local time of day, "14:03:59"; "--:--:--" for 0.
std::string time_text(std::int64_t utc_ns);

}  // namespace stationd::supervisor

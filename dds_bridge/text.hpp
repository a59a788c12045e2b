// Text: how the tools write numbers, codes, states and events for people.
// Owned by nobody (pure functions).
// Any plain thread (they allocate).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "dds_bridge/messages.hpp"

namespace stationd::bus {

/// What came over the bus may be hostile: control characters become '?', so that no text moves the cursor.
/// Line ends stay where `lines` says so.
std::string printable(std::string_view text, bool lines = false);

/// Columns a text takes: its UTF-8 code points.
std::size_t columns_of(std::string_view text);
/// At most `width` columns; a '~' at the end of what was cut.
std::string cut(std::string_view text, std::size_t width);
/// Exactly `width` columns: cut, or padded with blanks.
std::string fit(std::string_view text, std::size_t width);
/// The same, at the right.
std::string fit_right(std::string_view text, std::size_t width);

/// "1 station", "2 stations", "2 misses".
std::string count_text(std::uint64_t count, std::string_view noun);

/// Rounded to what people read: "870ns", "12us", "1.3ms", "2.1s".
std::string short_duration(std::int64_t ns);

std::string code_id(std::uint32_t code);  ///< "ST1203"
std::string code_text(
    std::uint32_t code);  ///< "ST1203 real-time rights refused"; no such code: "ST9999"; 0: empty

/// STATE of a Status message: "RUNNING"; "STATE 7" for a number that no release knows.
std::string state_text(std::uint32_t state);
/// SEVERITY of an event: "info", "warning", "fault" (and whatever is above).
std::string severity_text(std::uint32_t severity);
/// The step's name, its number where it has none, "-" for neither.
std::string step_text(const Status& status);

/// Local time of day, "14:03:59"; "--:--:--" for 0.
std::string time_text(std::int64_t utc_ns);

/// The zone of local times then: "CET, UTC+01:00", or "UTC".
std::string zone_text(std::int64_t utc_ns);
/// ISO 8601 in local time, "2026-03-01T14:03:59.250+01:00"; empty for 0.
std::string iso_time(std::int64_t utc_ns);

/// What the event is about beside its station: the lost device, or what its TEXT says beyond the code's
/// name.
std::string event_source(const Gse& gse);
/// "14:03:59 robot fault ST2104 gripper holds an unknown part": one event in one line.
std::string event_text(const Gse& gse);

}  // namespace stationd::bus

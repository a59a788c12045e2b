// Text: how stationctl writes numbers, codes and states for people.
// Owned by nobody (pure functions).
// Any plain thread (they allocate).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "dds_bridge/messages.hpp"

namespace stationd::ctl {

/// What came over the bus may be hostile: control characters become '?'. Line ends stay where `lines` says
/// so.
std::string printable(std::string_view text, bool lines = false);

/// "870ns", "12us", "1.3ms", "2.1s".
std::string short_duration(std::int64_t ns);
std::string code_id(std::uint32_t code);      ///< "ST1203"
std::string code_text(std::uint32_t code);    ///< "ST1203 real-time rights refused"; 0: empty
std::string state_text(std::uint32_t state);  ///< "RUNNING"; "STATE 7"
std::string severity_text(std::uint32_t severity);
/// Local time, "14:03:59"; "--:--:--" for 0.
std::string time_text(std::int64_t utc_ns);
/// One event in one line.
std::string event_text(const bus::Gse& gse);

/// Rows of cells in aligned columns; `right`: columns whose numbers stand at the right. No line is wider than
/// `width` (0: any).
std::vector<std::string> aligned(const std::vector<std::vector<std::string>>& rows,
                                 const std::vector<bool>& right, std::size_t width);

}  // namespace stationd::ctl

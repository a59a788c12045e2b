// Replies: reads what a station or the supervisor answered.
// Owned by nobody (pure functions).
// Any plain thread (they allocate).
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ctl/json.hpp"
#include "dds_bridge/messages.hpp"

namespace stationd::ctl {

/// key=value pairs in the order of the text.
using Pairs = std::vector<std::pair<std::string, std::string>>;

/// The value of that key; null if there is none.
const std::string* find_value(const Pairs& pairs, std::string_view key);

/// A reply's BODY without the `id=N` that it begins with.
std::string without_id(const std::string& body);

/// The pairs of each line; nothing if a line is no pairs (a `done` before them is passed over). A value ends
/// where the next `key=` begins, so it may have blanks in it.
std::vector<Pairs> pairs_of(std::string_view body);

/// Adds what pairs_of() finds: `"values":{...}`, or `"rows":[{...},...]`, one for each line, where the lines
/// have the same keys.
void add_values(JsonObject& out, std::string_view body);

/// "is in FAULT: ST1205 scan made no progress. Cause: ... Remedy: ... Then: stationctl reset robot"
std::string fault_text(const bus::Status& status);

/// Why the station refused, with the code's name and, where the text itself does not say it, its remedy.
std::string refusal_text(const bus::MsgRes& reply);

}  // namespace stationd::ctl

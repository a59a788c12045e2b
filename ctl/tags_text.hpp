// TagsText: a station's tags, and what was forced or set, for people and as JSON.
// Owned by nobody (pure functions).
// The command's thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ctl/replies.hpp"

namespace stationd::ctl {

/// One piece of the answer to `tags`: a line of pairs for each tag.
struct TagRows {
  std::vector<Pairs> rows;
  std::string next;  ///< not empty: more are to be had with `tags after NEXT`
};
TagRows tag_rows(std::string_view body);

/// "conveyor is forced to true: the output stays safe until the station runs", from the answer to force,
/// unforce or set.
std::string change_text(std::string_view body);

/// A heading and a line for each tag.
std::vector<std::string> tags_table(const std::vector<Pairs>& rows);
/// {"station":...,"ok":true,"tags":[{"tag":...,"value":...,"quality":...,"forced":null,...}]}
std::string tags_json(const std::string& station, const std::vector<Pairs>& rows);

}  // namespace stationd::ctl

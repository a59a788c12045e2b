#include "ctl/tags_text.hpp"

#include <utility>

#include "ctl/json.hpp"
#include "ctl/table.hpp"
#include "dds_bridge/text.hpp"

namespace stationd::ctl {
namespace {

std::string text_of(const Pairs& pairs, std::string_view key) {
  const std::string* value = find_value(pairs, key);
  return value == nullptr ? "" : *value;
}

std::string unforced_text(const std::string& tag, const std::string& count) {
  if (tag != "all") return tag + (count == "0" ? " was not forced" : " is no longer forced");
  if (count == "0") return "no tag was forced";
  return count == "1" ? "1 tag is no longer forced" : count + " tags are no longer forced";
}

/// What may be set, and within which range.
std::string settable_text(const Pairs& row) {
  const std::string range = text_of(row, "range");
  if (find_value(row, "writable") == nullptr) return "";
  return range.empty() ? "yes" : range;
}

void nullable(JsonObject& out, std::string_view key, const Pairs& row) {
  const std::string* value = find_value(row, key);
  out.raw(key, value == nullptr ? "null" : json_quoted(*value));
}

}  // namespace

TagRows tag_rows(std::string_view body) {
  TagRows out;
  for (Pairs& line : pairs_of(body)) {
    if (find_value(line, "tag") != nullptr)
      out.rows.push_back(std::move(line));
    else
      out.next = text_of(line, "next");
  }
  return out;
}

std::string change_text(std::string_view body) {
  const std::vector<Pairs> lines = pairs_of(body);
  const Pairs pairs = lines.empty() ? Pairs{} : lines.front();
  const std::string tag = text_of(pairs, "tag");
  if (const std::string* count = find_value(pairs, "unforced")) return unforced_text(tag, *count);
  if (const std::string* value = find_value(pairs, "value"))
    return tag + " is set to " + *value + "; it was " + text_of(pairs, "before");
  if (const std::string* value = find_value(pairs, "forced")) {
    const std::string note = text_of(pairs, "note");
    return tag + " is forced to " + *value + (note.empty() ? "" : ": " + note);
  }
  return std::string(body);
}

std::vector<std::string> tags_table(const std::vector<Pairs>& rows) {
  std::vector<std::vector<std::string>> cells;
  for (const Pairs& row : rows) {
    std::vector<std::string> line;
    for (const char* key : {"tag", "value", "quality", "forced", "area", "type", "unit"})
      line.push_back(bus::printable(text_of(row, key)));
    line.push_back(bus::printable(settable_text(row)));
    cells.push_back(std::move(line));
  }
  return table_lines(
      {{"TAG"}, {"VALUE", true}, {"QUALITY"}, {"FORCED TO"}, {"AREA"}, {"TYPE"}, {"UNIT"}, {"CAN BE SET"}},
      std::move(cells), 0);
}

std::string tags_json(const std::string& station, const std::vector<Pairs>& rows) {
  std::vector<std::string> values;
  for (const Pairs& row : rows) {
    JsonObject out;
    for (const char* key : {"tag", "value", "quality", "area", "type"}) out.text(key, text_of(row, key));
    nullable(out, "forced", row);
    out.flag("writable", find_value(row, "writable") != nullptr);
    nullable(out, "range", row);
    nullable(out, "unit", row);
    values.push_back(out.str());
  }
  return JsonObject().text("station", station).flag("ok", true).raw("tags", json_array(values)).str();
}

}  // namespace stationd::ctl

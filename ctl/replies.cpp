#include "ctl/replies.hpp"

#include <algorithm>
#include <set>

#include "dds_bridge/text.hpp"
#include "scan/codes.hpp"

namespace stationd::ctl {
namespace {

using bus::code_id;
using bus::code_text;
using bus::printable;

std::vector<std::string_view> split(std::string_view text, char at) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(at);
    if (const std::string_view part = text.substr(0, end); !part.empty()) parts.push_back(part);
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

bool is_key(std::string_view text) {
  const auto belongs = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
  };
  return !text.empty() && std::ranges::all_of(text, belongs);
}

Pairs pairs_of_line(std::string_view line) {
  Pairs pairs;
  for (const std::string_view word : split(line, ' ')) {
    const std::size_t equals = word.find('=');
    if (equals != std::string_view::npos && is_key(word.substr(0, equals))) {
      pairs.emplace_back(word.substr(0, equals), word.substr(equals + 1));
    } else if (!pairs.empty()) {
      pairs.back().second += " " + std::string(word);
    } else if (word != "done") {
      return {};
    }
  }
  return pairs;
}

std::string json_of(const Pairs& pairs) {
  JsonObject out;
  for (const auto& [key, value] : pairs) out.text(key, value);
  return out.str();
}

}  // namespace

const std::string* find_value(const Pairs& pairs, std::string_view key) {
  const auto it = std::ranges::find(pairs, key, &Pairs::value_type::first);
  return it == pairs.end() ? nullptr : &it->second;
}

std::string without_id(const std::string& body) {
  if (!body.starts_with("id=")) return body;
  const std::size_t blank = body.find(' ');
  return blank == std::string::npos ? "" : body.substr(blank + 1);
}

std::vector<Pairs> pairs_of(std::string_view body) {
  std::vector<Pairs> lines;
  for (const std::string_view line : split(body, '\n')) {
    Pairs pairs = pairs_of_line(line);
    if (pairs.empty()) return {};
    lines.push_back(std::move(pairs));
  }
  return lines;
}

void add_values(JsonObject& out, std::string_view body) {
  const std::vector<Pairs> lines = pairs_of(body);
  if (lines.empty()) return;
  Pairs all;
  std::set<std::string> keys;
  for (const Pairs& line : lines)
    for (const auto& pair : line) {
      keys.insert(pair.first);
      all.push_back(pair);
    }
  if (keys.size() == all.size()) {
    out.raw("values", json_of(all));
    return;
  }
  std::vector<std::string> rows;
  for (const Pairs& line : lines) rows.push_back(json_of(line));
  out.raw("rows", json_array(rows));
}

std::string fault_text(const bus::Status& status) {
  const CodeInfo* info = find_code(status.FAULT);
  const std::string station = printable(status.STATION);
  std::string out = "it is in FAULT: " + code_text(status.FAULT) + ".";
  if (info == nullptr)
    out += " What it means: stationctl msg " + station + " describe " + code_id(status.FAULT) + ".";
  else
    out += " Cause: " + std::string(info->cause) + " Remedy: " + std::string(info->remedy);
  return out + " Then: stationctl reset " + station;
}

std::string refusal_text(const bus::MsgRes& reply) {
  std::string why = printable(without_id(reply.BODY));
  if (why.starts_with("refused: ")) why.erase(0, 9);
  if (reply.STATUS == 0) return why;
  if (why.find(code_id(reply.STATUS)) == std::string::npos)
    why += why.empty() ? code_text(reply.STATUS) : " (" + code_text(reply.STATUS) + ")";
  const CodeInfo* info = find_code(reply.STATUS);
  if (info == nullptr || info->code == code::not_in_fault) return why;  // which needs no remedy
  if (why.ends_with(".")) why.pop_back();
  return why + ". Remedy: " + std::string(info->remedy);
}

}  // namespace stationd::ctl

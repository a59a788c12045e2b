#include "dds_bridge/body.hpp"

#include <algorithm>

#include "dds_bridge/type_table.hpp"

namespace stationd::bus {
namespace {

constexpr std::size_t kMaxFrom = 255;
constexpr std::size_t kMaxId = 64;
constexpr std::string_view kBlanks = " \t\r\n";

bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte < 0x20 || byte == 0x7F) && kBlanks.find(c) == std::string_view::npos;
}

/// Takes `from` or `id`; the problem, if there is one.
std::string take_address(std::string& place, std::string_view key, std::string_view value,
                         std::size_t limit) {
  if (!place.empty()) return std::string(key) + " is given twice";
  if (value.size() > limit) return std::string(key) + " is longer than " + std::to_string(limit) + " bytes";
  if (!is_utf8(value) || std::ranges::any_of(value, is_control)) return std::string(key) + " is not a name";
  place = value;
  return {};
}

std::string take_word(Body& body, std::string_view word) {
  const std::size_t equals = word.find('=');
  if (equals == std::string_view::npos) {
    body.words.emplace_back(word);
    return {};
  }
  const std::string_view key = word.substr(0, equals), value = word.substr(equals + 1);
  if (key == "from") return take_address(body.from, key, value, kMaxFrom);
  if (key == "id") return take_address(body.id, key, value, kMaxId);
  if (key.empty()) return "a value without a key";
  if (std::ranges::find(body.pairs, key, &std::pair<std::string, std::string>::first) != body.pairs.end()) {
    return std::string(key) + " is given twice";
  }
  body.pairs.emplace_back(key, value);
  return {};
}

}  // namespace

Body parse_body(std::string_view text, std::size_t max_bytes) {
  Body body;
  if (text.size() > max_bytes) {
    body.problem = "the body has " + std::to_string(text.size()) + " bytes, at most " +
                   std::to_string(max_bytes) + " are taken";
  } else if (!is_utf8(text)) {
    body.problem = "the body is not UTF-8";
  } else if (std::ranges::any_of(text, is_control)) {
    body.problem = "the body has control characters";
  }
  while (!text.empty()) {
    const std::size_t begin = text.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) break;
    text.remove_prefix(begin);
    const std::size_t length = std::min(text.find_first_of(kBlanks), text.size());
    std::string problem = take_word(body, text.substr(0, length));
    if (body.problem.empty()) body.problem = std::move(problem);
    text.remove_prefix(length);
  }
  if (!body.ok()) {  // nothing of it may be acted on
    body.words.clear();
    body.pairs.clear();
  }
  return body;
}

std::string reply_prefix(const Body& body) { return body.id.empty() ? "" : "id=" + body.id + " "; }

std::string clipped(std::string_view text, std::size_t max_bytes) {
  if (text.size() <= max_bytes) return std::string(text);
  std::size_t end = max_bytes;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80) --end;
  return std::string(text.substr(0, end));
}

}  // namespace stationd::bus

#include "config/syntax.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace stationd::config {
namespace {

bool has(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

std::string_view line_of(std::string_view text, std::uint32_t number) {
  for (std::uint32_t at = 1; at < number; ++at) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// `KEY = VALUE # comment` of one line; both empty where there is no `=`.
struct Pair {
  std::string_view key, value;
};

Pair pair_of(std::string_view line) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return {};
  const std::string_view behind = line.substr(equals + 1);
  const bool quoted = trimmed(behind).starts_with("\"") || trimmed(behind).starts_with("'");
  return {trimmed(line.substr(0, equals)), trimmed(quoted ? behind : behind.substr(0, behind.find('#')))};
}

/// What the parser's words alone give away.
using Rule = std::pair<std::string_view, std::string_view>;
constexpr auto kRules = std::to_array<Rule>({
    {"cannot redefine existing table",
     "a heading stands once: put all its keys under one, or write [[NAME]] for several of a kind"},
    {"cannot redefine existing", "a key stands once in its section: remove one of the two"},
    {"unknown escape", "a backslash in text is written \\\\, or the text stands in single quotation marks"},
    {"utf-8", "save the file as UTF-8"},
    {"table header: expected ']'", "the heading's closing bracket is missing, as in [NAME] or [[NAME]]"},
    {"table header", "a heading stands alone on its line, as in [NAME] or [[NAME]]"},
    {"saw comma", "a value is missing before the comma"},
    {"parsing array", "the values of a list are parted by commas, and ] ends it"},
    {"dangling comma", "no comma stands before }"},
    {"inline table", "the pairs of { ... } are parted by commas, and } ends them on the same line"},
    {"expected '=', saw ':'", "a value follows \"=\", not \":\""},
    {"expected '='", "\"=\" is missing: each line is KEY = VALUE"},
    {"tables, whitespace or comments, saw '='", "the key before \"=\" is missing"},
    {"tables, whitespace or comments, saw '/'", "a comment begins with #"},
    {"tables, whitespace or comments, saw ';'", "a comment begins with #"},
    {"expected value, saw", "the value behind \"=\" is missing"},
});

std::string hint_for_string(std::string_view line, Position at, std::string_view said) {
  if (has(said, "end-of-file") || at.column > line.size()) return "the closing quotation mark is missing";
  return has(said, "control characters") ? "a control character does not belong into text" : "";
}

std::string hint_for_value(const Pair& pair) {
  const std::string_view value = pair.value;
  if (value.empty()) return "";
  if (value.front() == '"' || value.front() == '\'')
    return "something follows the closing quotation mark; inside text it is written \\\"";
  if (has(value, "\xE2\x80\x9C") || has(value, "\xE2\x80\x9D"))
    return "take straight quotation marks: \"...\"";
  std::string word(value);
  std::ranges::transform(word, word.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
  static constexpr auto kSwitches =
      std::to_array<std::string_view>({"true", "false", "on", "off", "yes", "no"});
  if (std::ranges::find(kSwitches, word) != kSwitches.end())
    return "true and false are the words for a boolean, in small letters";
  if (has(value, "=")) return "each KEY = VALUE stands on a line of its own, with one \"=\"";
  if (has(value, "//")) return "a comment begins with #";
  if (value.front() == '[' || value.front() == '{') return "";
  return "what is no number stands in quotation marks: " + std::string(pair.key) + " = \"" +
         std::string(value) + "\"";
}

std::string hint_for(std::string_view line, Position at, std::string_view said) {
  if (has(said, "parsing string") || has(said, "parsing literal string"))
    if (std::string hint = hint_for_string(line, at, said); !hint.empty()) return hint;
  const Pair pair = pair_of(line);
  if (has(said, "expected '='") && pair.key.find(' ') != std::string_view::npos) return "a key is one word";
  for (const auto& [part, hint] : kRules)
    if (has(said, part)) return std::string(hint);
  return hint_for_value(pair);
}

}  // namespace

std::string syntax_error_text(std::string_view file_text, Position at, std::string_view said) {
  const std::string hint = hint_for(line_of(file_text, at.line), at, said);
  // "Error while parsing decimal integer: expected digit, saw 'm'": what it took the text for only misleads.
  if (const std::size_t what = said.find(": "); said.starts_with("Error while") && what != said.npos)
    said.remove_prefix(what + 2);
  return "syntax error: " + std::string(said) + (hint.empty() ? "" : "; ") + hint +
         " (the rest of the file is checked once this is mended)";
}

}  // namespace stationd::config

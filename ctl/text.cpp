#include "ctl/text.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>

#include "scan/codes.hpp"

namespace stationd::ctl {
namespace {

template <class... T> std::string formatted(const char* format, T... values) {
  std::array<char, 64> buffer{};
  const int n = std::snprintf(buffer.data(), buffer.size(), format, values...);
  if (n <= 0) return {};
  return {buffer.data(), std::min(static_cast<std::size_t>(n), buffer.size() - 1)};
}

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return !continues(c); }));
}

std::string cut(std::string text, std::size_t width) {
  if (width == 0 || columns_of(text) <= width) return text;
  std::size_t at = 0;
  for (std::size_t columns = 0; columns + 1 < width; ++columns)
    for (++at; at < text.size() && continues(text[at]);) ++at;
  return text.substr(0, at) + "~";
}

}  // namespace

std::string printable(std::string_view text, bool lines) {
  std::string out(text);
  for (char& c : out) {
    const bool control = static_cast<unsigned char>(c) < 0x20U || c == 0x7F;
    if (control && !(lines && c == '\n')) c = '?';
  }
  // C1 controls arrive in UTF-8 as C2 80 to C2 9F; some terminals obey them.
  for (std::size_t i = 0; i + 1 < out.size(); ++i)
    if (out[i] == '\xC2' && static_cast<unsigned char>(out[i + 1]) < 0xA0U) out.replace(i, 2, "?");
  return out;
}

std::string short_duration(std::int64_t ns) {
  const auto value = static_cast<double>(ns);
  if (ns < 1'000) return formatted("%.0fns", value);
  if (ns < 1'000'000) return formatted("%.0fus", value / 1e3);
  if (ns < 1'000'000'000) return formatted("%.1fms", value / 1e6);
  return formatted("%.1fs", value / 1e9);
}

std::string code_id(std::uint32_t code) { return formatted("ST%04u", code); }

std::string code_text(std::uint32_t code) {
  if (code == 0) return {};
  const CodeInfo* info = find_code(code);
  return info == nullptr ? code_id(code) : code_id(code) + " " + std::string(info->name);
}

std::string state_text(std::uint32_t state) {
  if (state <= static_cast<std::uint32_t>(StationState::FAULT))
    return std::string(name_of(static_cast<StationState>(state)));
  return formatted("STATE %u", state);
}

std::string severity_text(std::uint32_t severity) {
  return std::string(name_of(static_cast<Severity>(std::min(severity, 2U))));
}

std::string time_text(std::int64_t utc_ns) {
  if (utc_ns <= 0) return "--:--:--";
  const auto seconds = static_cast<std::time_t>(utc_ns / 1'000'000'000);
  std::tm parts{};
  if (localtime_r(&seconds, &parts) == nullptr) return "--:--:--";
  return formatted("%02d:%02d:%02d", parts.tm_hour, parts.tm_min, parts.tm_sec);
}

std::string event_text(const bus::Gse& gse) {
  std::string out = time_text(gse.SOURCE_TIME) + " ";
  out += gse.STATION.empty() ? "(no name)" : printable(gse.STATION);
  const bool plain = gse.SEQ == 0;  // a Table 4 writer says no more than ERROR and STATUS
  const std::uint32_t severity = plain && gse.ERROR ? 2 : gse.SEVERITY;
  const bool gone = severity != 0 && !(plain ? gse.ERROR : gse.ACTIVE);
  out += " " + severity_text(severity) + " " + (gone ? "gone: " : "") + code_text(gse.STATUS);
  if (!gse.EDGE && !gone) out += " (still)";
  const CodeInfo* info = find_code(gse.STATUS);
  if (!gse.TEXT.empty() && (info == nullptr || gse.TEXT != info->name)) out += ": " + printable(gse.TEXT);
  return out;
}

std::vector<std::string> aligned(const std::vector<std::vector<std::string>>& rows,
                                 const std::vector<bool>& right, std::size_t width) {
  std::vector<std::size_t> widths(right.size(), 0);
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], columns_of(row[c]));
  std::vector<std::string> lines;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string padding(widths[c] - columns_of(row[c]), ' ');
      line += (c == 0 ? "" : "  ") + (right[c] ? padding + row[c] : row[c] + padding);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    lines.push_back(cut(std::move(line), width));
  }
  return lines;
}

}  // namespace stationd::ctl

#include "dds_bridge/text.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>

#include "scan/codes.hpp"

namespace stationd::bus {
namespace {

template <class... T> std::string formatted(const char* format, T... values) {
  std::array<char, 64> buffer{};
  const int n = std::snprintf(buffer.data(), buffer.size(), format, values...);
  if (n <= 0) return {};
  return {buffer.data(), std::min(static_cast<std::size_t>(n), buffer.size() - 1)};
}

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

/// Bytes that the first `columns` code points take.
std::size_t bytes_of(std::string_view text, std::size_t columns) {
  std::size_t at = 0;
  while (at < text.size() && columns > 0) {
    ++at;
    while (at < text.size() && continues(text[at])) ++at;
    --columns;
  }
  return at;
}

/// "+01:00"
std::string offset_text(long seconds) {
  const long minutes = (seconds < 0 ? -seconds : seconds) / 60;
  return formatted("%c%02ld:%02ld", seconds < 0 ? '-' : '+', minutes / 60, minutes % 60);
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

std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return !continues(c); }));
}

std::string cut(std::string_view text, std::size_t width) {
  if (columns_of(text) <= width) return std::string(text);
  if (width == 0) return {};
  return std::string(text.substr(0, bytes_of(text, width - 1))) + "~";
}

std::string fit(std::string_view text, std::size_t width) {
  std::string out = cut(text, width);
  out.append(width - columns_of(out), ' ');
  return out;
}

std::string fit_right(std::string_view text, std::size_t width) {
  const std::string out = cut(text, width);
  return std::string(width - columns_of(out), ' ') + out;
}

std::string count_text(std::uint64_t count, std::string_view noun) {
  const std::string one = std::to_string(count) + " " + std::string(noun);
  return count == 1 ? one : one + (noun.ends_with('s') ? "es" : "s");
}

std::string short_duration(std::int64_t ns) {
  if (ns < 0) return "-" + short_duration(ns == INT64_MIN ? INT64_MAX : -ns);
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

std::string step_text(const Status& status) {
  if (!status.STEP_NAME.empty()) return printable(status.STEP_NAME);
  return status.STEP == 0 ? "-" : std::to_string(status.STEP);
}

std::string zone_text(std::int64_t utc_ns) {
  const auto seconds = static_cast<std::time_t>(utc_ns / 1'000'000'000);
  std::tm parts{};
  if (localtime_r(&seconds, &parts) == nullptr) return "UTC";
  const std::string name = parts.tm_zone == nullptr ? "" : parts.tm_zone;
  if (parts.tm_gmtoff == 0 && (name.empty() || name == "UTC")) return "UTC";
  const std::string offset = "UTC" + offset_text(parts.tm_gmtoff);
  return name.empty() || name[0] == '+' || name[0] == '-' ? offset : name + ", " + offset;
}

std::string iso_time(std::int64_t utc_ns) {
  const auto seconds = static_cast<std::time_t>(utc_ns / 1'000'000'000);
  std::tm parts{};
  if (utc_ns <= 0 || localtime_r(&seconds, &parts) == nullptr) return {};
  return formatted("%04d-%02d-%02dT%02d:%02d:%02d.%03d", parts.tm_year + 1900, parts.tm_mon + 1,
                   parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec,
                   static_cast<int>(utc_ns / 1'000'000 % 1'000)) +
         offset_text(parts.tm_gmtoff);
}

std::string time_text(std::int64_t utc_ns) {
  if (utc_ns <= 0) return "--:--:--";
  const auto seconds = static_cast<std::time_t>(utc_ns / 1'000'000'000);
  std::tm parts{};
  if (localtime_r(&seconds, &parts) == nullptr) return "--:--:--";
  return formatted("%02d:%02d:%02d", parts.tm_hour, parts.tm_min, parts.tm_sec);
}

std::string event_source(const Gse& gse) {
  const CodeInfo* info = find_code(gse.STATUS);
  std::string_view text = gse.TEXT;
  if (info != nullptr && text.starts_with(info->name)) {
    text.remove_prefix(info->name.size());
    if (text.starts_with(": ")) text.remove_prefix(2);
  }
  return std::string(text);
}

std::string event_text(const Gse& gse) {
  std::string out = time_text(gse.SOURCE_TIME) + " ";
  out += gse.STATION.empty() ? "(no name)" : printable(gse.STATION);
  const bool plain = gse.SEQ == 0;  // a Table 4 writer says no more than ERROR and STATUS
  const std::uint32_t severity = plain && gse.ERROR ? 2 : gse.SEVERITY;
  const bool gone = severity != 0 && !(plain ? gse.ERROR : gse.ACTIVE);
  out += " " + severity_text(severity) + " " + (gone ? "gone: " : "");
  out += gse.STATUS == 0 && gse.TEXT.empty() ? "(no code)" : code_text(gse.STATUS);
  if (!gse.EDGE && !gone) out += " (still)";
  const std::string rest = event_source(gse);
  return rest.empty() ? out : out + ": " + printable(rest);
}

}  // namespace stationd::bus

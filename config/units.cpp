#include "config/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <vector>

namespace stationd::config {
namespace {

constexpr std::array<Unit, 5> kSizes = {
    {{"MiB", 1 << 20}, {"KiB", 1 << 10}, {"MB", 1'000'000}, {"kB", 1'000}, {"B", 1}}};

bool is_letter_or_digit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

bool is_word(std::string_view text, std::string_view also) {
  return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), [&](char c) {
    return is_letter_or_digit(c) || also.find(c) != std::string_view::npos;
  });
}

constexpr std::array<std::pair<std::string_view, io::Table>, 4> kTables = {
    {{"co", io::Table::coil},
     {"di", io::Table::discrete_input},
     {"ir", io::Table::input_register},
     {"hr", io::Table::holding_register}}};

/// The numbers of data sheets ("40001"): first digit 0 coil, 1 discrete input, 3 input, 4 holding register.
struct ModiconAddress {
  io::Table table;
  std::int64_t address;
};
std::optional<ModiconAddress> as_modicon(std::string_view digits) {
  if (digits.size() != 5 && digits.size() != 6) return std::nullopt;
  const auto number = parse_integer(digits.substr(1));
  if (!number || *number < 1 || *number > 65536) return std::nullopt;
  switch (digits.front()) {
    case '0': return ModiconAddress{io::Table::coil, *number - 1};
    case '1': return ModiconAddress{io::Table::discrete_input, *number - 1};
    case '3': return ModiconAddress{io::Table::input_register, *number - 1};
    case '4': return ModiconAddress{io::Table::holding_register, *number - 1};
    default: return std::nullopt;
  }
}

constexpr std::string_view kPointForm =
    "allowed is DEVICE:TABLE:ADDRESS, the table being di, co, ir or hr and the address counted from 0, as in "
    "\"remote-io-1:di:0\"";

std::string modicon_error(std::string_view text, std::string_view device, const ModiconAddress& modicon) {
  return "found \"" + std::string(text) +
         "\", an address in the 40001 style; allowed is the table and the address "
         "counted from 0, here \"" +
         std::string(device) + ":" + std::string(short_name(modicon.table)) + ":" +
         std::to_string(modicon.address) + "\"";
}

}  // namespace

std::optional<std::int64_t> parse_size_bytes(std::string_view text) { return parse_with_unit(text, kSizes); }
std::string size_text(std::int64_t bytes) { return with_unit(bytes, kSizes); }

std::optional<std::int64_t> parse_integer(std::string_view text) {
  int base = 10;
  if (text.substr(0, 2) == "0x") {
    base = 16;
    text.remove_prefix(2);
    if (!text.empty() && text.front() == '-') return std::nullopt;
  }
  std::int64_t value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc{} || rest != text.data() + text.size() || text.empty()) return std::nullopt;
  return value;
}

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || rest != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<TagType> parse_type(std::string_view text) {
  for (int i = 0; i <= static_cast<int>(TagType::STRING); ++i)
    if (name_of(static_cast<TagType>(i)) == text) return static_cast<TagType>(i);
  return std::nullopt;
}

bool is_ipv4(std::string_view text) {
  int parts = 0;
  while (true) {
    const std::size_t dot = text.find('.');
    const std::string_view part = text.substr(0, dot);
    const bool digits = std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (part.empty() || part.size() > 3 || !digits || (part.size() > 1 && part.front() == '0')) return false;
    if (parse_integer(part).value_or(256) > 255) return false;
    ++parts;
    if (dot == std::string_view::npos) return parts == 4;
    text.remove_prefix(dot + 1);
  }
}

bool is_name(std::string_view text) { return is_word(text, "-_"); }
bool is_tag_name(std::string_view text) { return is_word(text, "_."); }

std::optional<HostPort> parse_host_port(std::string_view text, std::string& error) {
  const std::size_t colon = text.find(':');
  const std::string_view host = text.substr(0, colon);
  const auto port = colon == std::string_view::npos ? std::optional<std::int64_t>(502)
                                                    : parse_integer(text.substr(colon + 1));
  if (!is_ipv4(host)) {
    error = "found \"" + std::string(text) +
            "\"; allowed is an IPv4 address and a port, as in \"192.168.0.10:502\" "
            "(names are not resolved)";
    return std::nullopt;
  }
  if (!port || *port < 1 || *port > 65535) {
    error = "found \"" + std::string(text) +
            "\", whose port is none; allowed are 1 to 65535, as in "
            "\"192.168.0.10:502\"";
    return std::nullopt;
  }
  return HostPort{std::string(host), static_cast<std::uint16_t>(*port)};
}

std::optional<PointAddress> parse_point(std::string_view text, std::string& error) {
  const std::string found = "found \"" + std::string(text) + "\"; ";
  const std::size_t first = text.find(':');
  const std::string_view device = text.substr(0, first);
  const std::string_view rest = first == std::string_view::npos ? std::string_view{} : text.substr(first + 1);
  const std::size_t second = rest.find(':');
  if (second == std::string_view::npos) {
    const auto modicon = as_modicon(rest);
    error = modicon ? modicon_error(text, device, *modicon) : found + std::string(kPointForm);
    return std::nullopt;
  }
  const std::string_view table_name = rest.substr(0, second);
  const std::string_view digits = rest.substr(second + 1);
  const auto table =
      std::find_if(kTables.begin(), kTables.end(), [&](const auto& t) { return t.first == table_name; });
  const auto address = parse_integer(digits);
  if (!is_name(device) || table == kTables.end() || !address) {
    error = found + std::string(kPointForm);
    return std::nullopt;
  }
  const auto modicon = as_modicon(digits);
  if (modicon && modicon->table == table->second) {
    error = modicon_error(text, device, *modicon);
    if (*address <= 65535) {
      std::array<char, 8> hex{};
      const auto end = std::to_chars(hex.data(), hex.data() + hex.size(), *address, 16).ptr;
      error += "; an address that really is " + std::to_string(*address) + " from 0 is written 0x" +
               std::string(hex.data(), end);
    }
    return std::nullopt;
  }
  if (*address < 0 || *address > 65535) {
    error = found + "addresses go from 0 to 65535";
    return std::nullopt;
  }
  return PointAddress{std::string(device), table->second, static_cast<std::uint16_t>(*address)};
}

std::string_view short_name(io::Table table) noexcept {
  for (const auto& [name, value] : kTables)
    if (value == table) return name;
  return "?";
}

}  // namespace stationd::config

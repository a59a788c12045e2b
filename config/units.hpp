// Units and addresses as configuration files write them: sizes, IPv4 addresses, points of a device, names.
// Owned by nobody; pure functions.
// Set-up only; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "io/options.hpp"
#include "scan/suggestion.hpp"
#include "scan/units.hpp"

namespace stationd::config {

using stationd::duration_text;
using stationd::parse_duration_ns;

/// "8KiB", "1MiB", "512B", "64kB".
std::optional<std::int64_t> parse_size_bytes(std::string_view text);
std::string size_text(std::int64_t bytes);

std::optional<std::int64_t> parse_integer(std::string_view text);  ///< decimal, or hexadecimal after 0x
std::optional<double> parse_number(std::string_view text);
std::optional<TagType> parse_type(std::string_view text);  ///< "UDINT"
bool is_ipv4(std::string_view text);
bool is_name(std::string_view text);      ///< letters, digits, - and _; 1..64
bool is_tag_name(std::string_view text);  ///< letters, digits, _ and .; 1..64

struct HostPort {
  std::string host;
  std::uint16_t port = 0;
};
/// "192.168.0.10:502" or "192.168.0.10" (port 502). On failure `error` says what is allowed.
std::optional<HostPort> parse_host_port(std::string_view text, std::string& error);

struct PointAddress {
  std::string device;
  io::Table table = io::Table::coil;
  std::uint16_t address = 0;
};
/// "remote-io-1:di:0". On failure `error` says what was wrong and what is allowed.
std::optional<PointAddress> parse_point(std::string_view text, std::string& error);

std::string_view short_name(io::Table table) noexcept;  ///< "co", "di", "hr", "ir"

using stationd::nearest;
using stationd::suggestion;

}  // namespace stationd::config

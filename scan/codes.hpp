// Codes: every fault, warning and event that an operator can see, with cause and remedy; the one table of them.
// Owned by nobody (constant data). docs/codes.md is made from it.
// Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "scan/messages.hpp"

namespace stationd {

/// One row. Numbers are stable: never reuse one. 1xxx runtime, 2xxx and 3xxx the cell's programs, 9xxx users' programs.
/// Written for people as ST1203, on the wire (STATUS) as 1203.
struct CodeInfo {
  std::uint32_t code;
  Severity severity;
  std::string_view name;    ///< short, for lists: "gripper holds an unknown part"
  std::string_view cause;
  std::string_view remedy;  ///< what the operator does; for a fault that asks: the question
};

/// All rows, ascending by code.
std::span<const CodeInfo> all_codes() noexcept;

/// The row of that code; null if there is none.
const CodeInfo* find_code(std::uint32_t code) noexcept;

namespace code {
constexpr std::uint32_t overrun = 1001;
constexpr std::uint32_t device_lost = 1101;
constexpr std::uint32_t remote_lost = 1102;
constexpr std::uint32_t retained_refused = 1201;
constexpr std::uint32_t retained_not_written = 1202;
constexpr std::uint32_t realtime_refused = 1203;
constexpr std::uint32_t events_lost = 1204;
constexpr std::uint32_t watchdog = 1205;
constexpr std::uint32_t order_refused = 1301;
constexpr std::uint32_t not_in_fault = 1302;
constexpr std::uint32_t still_in_fault = 1303;
constexpr std::uint32_t start_in_wrong_state = 1304;
constexpr std::uint32_t start_overtaken = 1305;
constexpr std::uint32_t unknown_tag = 1306;
constexpr std::uint32_t unknown_verb = 1307;
constexpr std::uint32_t body_invalid = 1308;
constexpr std::uint32_t busy = 1309;
constexpr std::uint32_t value_invalid = 1310;
constexpr std::uint32_t permit_revoked = 1311;
}  // namespace code

}  // namespace stationd

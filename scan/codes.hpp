// Codes: every fault, warning and event that an operator can see, with cause and remedy; the one table of
// them.
// Owned by nobody (constant data). docs/codes.md is made from it.
// Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "scan/messages.hpp"
#include "scan/nonblocking.hpp"

namespace stationd {

/// One row. Numbers are stable: never reuse one. 1xxx runtime, 2xxx and 3xxx the cell's programs, 9xxx users'
/// programs.
/// Written for people as ST1203, on the wire (STATUS) as 1203.
struct CodeInfo {
  std::uint32_t code;
  Severity severity;
  std::string_view name;  ///< short, for lists: "gripper holds an unknown part"
  std::string_view cause;
  std::string_view remedy;  ///< what the operator does; for a fault that asks: the question
};

/// All rows, ascending by code.
std::span<const CodeInfo> all_codes() noexcept;

/// Whether the fault asks the operator to look: reset and Start are the answer (its remedy says to what).
constexpr bool is_question(const CodeInfo& info) noexcept {
  return info.severity == Severity::fault && info.remedy.find('?') != std::string_view::npos;
}

/// The row of that code; null if there is none.
const CodeInfo* find_code(std::uint32_t code) noexcept STATIOND_NONBLOCKING;

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
constexpr std::uint32_t not_forceable = 1312;
constexpr std::uint32_t forces_full = 1313;
constexpr std::uint32_t not_writable = 1314;
constexpr std::uint32_t tag_forced = 1401;
constexpr std::uint32_t tag_unforced = 1402;
constexpr std::uint32_t tag_set = 1403;

// The cell's programs: actuators and sensors (20xx, 21xx), pallets (22xx, 23xx), parts (24xx), waiting
// (25xx).
constexpr std::uint32_t inputs_lost = 2001;
constexpr std::uint32_t record_not_saved = 2002;
constexpr std::uint32_t step_timeout = 2003;
constexpr std::uint32_t entry_stopper_jammed = 2101;
constexpr std::uint32_t stopper_jammed = 2102;
constexpr std::uint32_t clamp_jammed = 2103;
constexpr std::uint32_t press_jammed = 2104;
constexpr std::uint32_t arm_height_jammed = 2105;
constexpr std::uint32_t arm_sideways_jammed = 2106;
constexpr std::uint32_t gripper_jammed = 2107;
constexpr std::uint32_t end_switches_conflict = 2108;
constexpr std::uint32_t arm_astray = 2109;
constexpr std::uint32_t press_no_seat = 2110;
constexpr std::uint32_t pallet_stuck_at_entry = 2201;
constexpr std::uint32_t pallet_stuck_in_transfer = 2202;
constexpr std::uint32_t pallet_stuck_in_position = 2203;
constexpr std::uint32_t pallet_removed = 2204;
constexpr std::uint32_t pallet_vanished = 2205;
constexpr std::uint32_t transfer_occupied = 2206;
constexpr std::uint32_t pallet_missing = 2207;
constexpr std::uint32_t code_unreadable = 2301;
constexpr std::uint32_t code_unknown = 2302;
constexpr std::uint32_t magazine_empty = 2401;
constexpr std::uint32_t shelf_full = 2402;
constexpr std::uint32_t pick_failed = 2403;
constexpr std::uint32_t part_lost = 2404;
constexpr std::uint32_t place_failed = 2405;
constexpr std::uint32_t gripper_unknown_part = 2406;
constexpr std::uint32_t gripper_wrong_part = 2407;
constexpr std::uint32_t unexpected_part = 2408;
constexpr std::uint32_t piece_lost = 2409;
constexpr std::uint32_t place_taken = 2410;
constexpr std::uint32_t next_not_ready = 2501;
constexpr std::uint32_t no_pallet = 2502;
// The cell's programs: identity of pieces and hand-over.
constexpr std::uint32_t announcement_gap = 3001;
constexpr std::uint32_t code_mismatch = 3002;
constexpr std::uint32_t pallet_unannounced = 3003;
constexpr std::uint32_t piece_swapped = 3004;
constexpr std::uint32_t begin_missing = 3005;
constexpr std::uint32_t begin_error = 3006;
constexpr std::uint32_t announcement_dropped = 3007;
constexpr std::uint32_t piece_given_up = 3008;
// The example program.
constexpr std::uint32_t example_inputs_lost = 9001;
constexpr std::uint32_t example_fill_timeout = 9002;
}  // namespace code

}  // namespace stationd

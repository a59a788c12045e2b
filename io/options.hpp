// Plain options of field I/O: what the configuration says about devices and points.
// Owned by the configuration; copied into devices at set-up.
// Set-up only.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scan/value.hpp"

namespace stationd::io {

/// Modbus's four tables. `Table::discrete_input` and `Table::input_register` are read-only.
enum class Table : std::uint8_t { coil, discrete_input, holding_register, input_register };

/// Tables of bits, for BOOL; the others are of 16-bit registers.
constexpr bool is_bits(Table table) noexcept {
  return table == Table::coil || table == Table::discrete_input;
}

/// Registers (or bits) that a value takes: 64-bit types 4, 32-bit ones 2, all others and bits 1.
constexpr std::uint32_t width_of(Table table, TagType type) noexcept {
  if (is_bits(table)) return 1;
  switch (type) {
    case TagType::DINT:
    case TagType::UDINT:
    case TagType::REAL: return 2;
    case TagType::LINT:
    case TagType::ULINT:
    case TagType::LREAL:
    case TagType::TIME: return 4;
    default: return 1;
  }
}

enum class Direction : std::uint8_t { input, output };

/// What an output does while its station has no permit: a value, or left as the device has it.
enum class SafeAction : std::uint8_t { value, hold };

/// One tag's place in a device.
struct Point {
  std::string tag;  ///< "STATION.TAG", for messages
  Table table = Table::coil;
  std::uint16_t address = 0;  ///< 0-based
  TagType type = TagType::
      BOOL;  ///< BOOL in bit tables; 16-bit types take 1 register, 32-bit 2, 64-bit 4, high word first
  Direction direction = Direction::input;
  SafeAction safe_action = SafeAction::value;  ///< outputs only
  Slot safe_value = 0;                         ///< outputs only, with SafeAction::value
};

enum class DeviceKind : std::uint8_t { modbus, simulated, null };

/// One field device: a connection, a unit behind it, a thread.
struct DeviceOptions {
  std::string name;
  DeviceKind kind = DeviceKind::modbus;
  std::string host = "127.0.0.1";         ///< IPv4 literal (modbus)
  std::uint16_t port = 502;               ///< modbus
  int unit = 1;                           ///< 1..247
  std::int64_t period_ns = 10'000'000;    ///< one exchange (all reads, all writes) per period, 1 ms to 60 s
  std::int64_t timeout_ns = 200'000'000;  ///< response and connect, total
  std::int64_t stale_after_ns = 50'000'000;  ///< inputs older than this are STALE
  std::int64_t bad_after_ns = 500'000'000;   ///< inputs older than this are BAD
  std::int64_t heartbeat_period_ns = 0;      ///< 0: none
  std::uint16_t heartbeat_register = 0;      ///< holding register, written with a counter
};

/// The simulated plant in the daemon's own process (DeviceKind::simulated).
struct PlantOptions {
  std::uint64_t seed = 1;
  std::uint32_t pallets = 0;         ///< pallets that the infeed gives; 0: without end
  std::int64_t step_ns = 1'000'000;  ///< fixed time step of the model
  double speed = 1.0;                ///< plant seconds per second
  std::string ledger_file;           ///< empty: none
};

}  // namespace stationd::io

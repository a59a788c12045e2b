// Plain types of the plant model: wiring numbers (docs/cell.md), motion times, types of piece, faults.
// Owned by whoever holds them.
// Any thread; no state of their own.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace stationd::plant {

inline constexpr int kUnits = 4;  ///< unit 1 loader, 2 robot, 3 sealer, 4 storage

inline constexpr std::size_t kDiscreteInputs = 20;
inline constexpr std::size_t kInputRegisters = 7;
inline constexpr std::size_t kCoils = 9;
inline constexpr std::size_t kHoldingRegisters = 2;

/// Discrete inputs by address (docs/cell.md).
namespace di {
inline constexpr std::size_t pallet_at_entry = 0, pallet_in_transfer = 1, pallet_in_position = 2,
                             next_entry_clear = 3, entry_stopper_is_open = 4, entry_stopper_is_closed = 5,
                             stopper_is_open = 6, stopper_is_closed = 7, clamp_is_closed = 8,
                             clamp_is_open = 9, arm_is_up = 10, arm_is_down = 11, gripper_is_open = 12,
                             gripper_is_closed = 13, part_in_gripper = 14, code_valid = 15, base_present = 16,
                             bearing_present = 16, lid_present = 16, piece_present = 16, shaft_present = 17,
                             press_is_up = 17, place_occupied = 17, press_is_down = 18, lid_seated = 19;
}
/// Input registers by address.
namespace ir {
inline constexpr std::size_t pallet_code_high = 0, pallet_code_low = 1, arm_position = 2, level_first = 3;
}
/// Coils by address.
namespace co {
inline constexpr std::size_t conveyor = 0, entry_stopper_open = 1, stopper_open = 2, clamp_close = 3,
                             read_code = 4, arm_enable = 5, arm_down = 6, gripper_close = 7, press_down = 8;
}
/// Holding registers by address.
namespace hr {
inline constexpr std::size_t arm_target = 0, heartbeat = 1;
}
/// Positions of the arm; the feeders (storage: shelves) follow from `feeder_first` on.
namespace arm {
inline constexpr std::uint16_t home = 1, over_pallet = 2, feeder_first = 3;
}

/// One unit as its Modbus tables show it. Inputs are the plant's to write, coils and holding registers the
/// controller's.
struct UnitIo {
  std::array<bool, kDiscreteInputs> discrete_inputs{};
  std::array<std::uint16_t, kInputRegisters> input_registers{};
  std::array<bool, kCoils> coils{};
  std::array<std::uint16_t, kHoldingRegisters> holding_registers{};

  std::uint32_t pallet_code() const noexcept {
    return (std::uint32_t{input_registers[0]} << 16) | input_registers[1];
  }
};

/// The four parts of a piece, in the order in which they are put together.
enum class Part : std::uint8_t { base, bearing, shaft, lid };
inline constexpr std::size_t kParts = 4;

/// Where a pallet can be. `outfeed` is behind storage only.
enum class Zone : std::uint8_t { entry, transfer, position, outfeed };

/// A type of piece as the plant's own judge knows it: `variant` by Part (1 or 2), `shelf` 1 or 2.
struct PieceType {
  std::uint32_t code = 0;
  std::array<std::uint8_t, kParts> variant{};
  std::int64_t press_ns = 0;
  std::uint8_t shelf = 1;
};

/// How long each motion takes from one end to the other.
struct MotionTimes {
  std::int64_t entry_ns = 400'000'000;     ///< through the entry zone to its stopper
  std::int64_t transfer_ns = 400'000'000;  ///< from the entry stopper to the work position
  std::int64_t leave_ns = 150'000'000;     ///< out of the work position
  std::int64_t infeed_ns = 300'000'000;    ///< the loader's entry zone clear, until the infeed fills it
  std::int64_t outfeed_ns = 300'000'000;   ///< an empty pallet behind storage, until it is taken
  std::int64_t entry_stopper_ns = 80'000'000;
  std::int64_t stopper_ns = 80'000'000;
  std::int64_t clamp_ns = 80'000'000;
  std::int64_t gripper_ns = 80'000'000;
  std::int64_t arm_height_ns = 150'000'000;  ///< up to down
  std::int64_t arm_pitch_ns = 150'000'000;   ///< sideways from one position to the one beside it
  std::int64_t press_ns = 200'000'000;       ///< up to down
  std::int64_t code_read_ns = 50'000'000;
};

struct PlantConfig {
  std::uint64_t seed = 1;            ///< draws the pallets' codes
  std::uint32_t pallets = 0;         ///< pallets that the infeed gives; 0: without end
  std::int64_t step_ns = 1'000'000;  ///< 100 us to 100 ms
  MotionTimes times;
  std::vector<PieceType> types = default_types();
  std::vector<std::uint32_t> codes;       ///< codes of the first pallets, in order; then the seed draws
  std::uint16_t magazine_capacity = 50;   ///< parts per magazine
  std::uint16_t shelf_capacity = 50;      ///< places per shelf
  bool automatic_operator = true;         ///< refills magazines and empties shelves
  std::uint16_t operator_threshold = 10;  ///< ... that stay at or below this
  std::int64_t operator_delay_ns = 5'000'000'000;  ///< ... for this long
  /// A unit drops its coils (all but gripper_close) when nothing was written to it for so long, once
  /// something was; plant time; 0: never.
  std::int64_t watchdog_ns = 0;

  static std::vector<PieceType> default_types();
};

/// What can be made to go wrong.
enum class FaultKind : std::uint8_t {
  sensor_stuck,        ///< discrete input `index` reads `value` (0 or 1), whatever is true
  register_stuck,      ///< input register `index` reads `value`
  actuator_jammed,     ///< what coil `index` drives stays where it is (belt: stands; code reader: off)
  arm_jammed_between,  ///< the arm sticks half-way at its next move sideways; goes on when cleared or freed
  magazine_empty,      ///< feeder `index` (0-based; storage: shelf full) is empty, refill is blocked
  code_unreadable,     ///< the code reader finds nothing
  code_wrong,          ///< the code reader reports `value`
  pallet_lost,  ///< once: a pallet is taken out by hand from zone `index` (0 entry, 1 transfer, 2 position)
  part_lost,    ///< once: what the gripper holds falls from it
  part_off_pallet,  ///< once: part `index` (0 base .. 3 lid) and what is on it falls off the pallet
  infeed_stops      ///< no new pallets (unit 1)
};

/// A fault from `from_ns` (plant time) for `duration_ns` (0: until cleared). One that happens once waits
/// within that time for its first opportunity.
struct Fault {
  FaultKind kind = FaultKind::sensor_stuck;
  int unit = 1;  ///< 1..4
  std::uint32_t index = 0;
  std::uint32_t value = 0;
  std::int64_t from_ns = 0;
  std::int64_t duration_ns = 0;
};

}  // namespace stationd::plant

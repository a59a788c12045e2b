// FaultTable: the faults that were injected into a plant, and what of them acts right now.
// Owned by its Plant.
// The thread that steps the plant.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "io/plant/types.hpp"

namespace stationd::plant {

/// "sensor_stuck", ...
std::string_view name_of(FaultKind kind) noexcept;

/// Reads what `plantsim --inject` takes: KIND:UNIT[.INDEX][=VALUE][@FROM][+DURATION]. KIND is a FaultKind's
/// name, or `sensor` or `jam` with the tag for INDEX ("sensor:2.pallet_in_position=1@5s+2s"). Times: ns, us,
/// ms, s. Throws std::invalid_argument that says what is wrong and what is allowed.
Fault parse_fault(std::string_view spec);

/// What acts on one unit in the present step.
struct UnitFaults {
  std::uint32_t stuck_mask = 0;  ///< by discrete input
  std::uint32_t stuck_value = 0;
  std::uint32_t register_mask = 0;  ///< by input register
  std::array<std::uint16_t, kInputRegisters> register_value{};
  std::uint32_t jam_mask = 0;    ///< by coil
  std::uint32_t empty_mask = 0;  ///< by feeder
  bool arm_jammed = false;
  bool code_unreadable = false;
  bool code_wrong = false;
  std::uint32_t code = 0;
  bool infeed_stops = false;

  bool jammed(std::size_t coil) const noexcept { return ((jam_mask >> coil) & 1U) != 0; }
};

class FaultTable {
 public:
  struct Entry {
    int id = 0;
    Fault fault;
  };

  FaultTable() { entries_.reserve(64); }

  /// The fault itself; throws std::invalid_argument naming what is out of range.
  static Fault checked(const Fault& fault);
  /// Throws as checked() does. The result is for clear().
  int add(const Fault& fault);
  void clear(int id) noexcept;
  void clear_all() noexcept;
  /// Clears the unit's faults of that kind; true if there was one.
  bool clear_kind(int unit, FaultKind kind) noexcept;

  bool empty() const noexcept { return entries_.empty(); }
  /// Works out what acts at `now_ns` and forgets what is over.
  void update(std::int64_t now_ns) noexcept;
  const UnitFaults& of(int unit) const noexcept { return active_[static_cast<std::size_t>(unit - 1)]; }

  /// Calls `happens(fault)` for each fault that happens once and is due; forgets it when that returns true.
  template <class Happens> void once(std::int64_t now_ns, Happens happens) {
    for (std::size_t i = 0; i < entries_.size();) {
      const Fault& fault = entries_[i].fault;
      if (is_once(fault.kind) && now_ns >= fault.from_ns && happens(fault)) {
        entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(i));
      } else {
        ++i;
      }
    }
  }

 private:
  static bool is_once(FaultKind kind) noexcept {
    return kind == FaultKind::pallet_lost || kind == FaultKind::part_lost ||
           kind == FaultKind::part_off_pallet;
  }

  std::vector<Entry> entries_;
  std::array<UnitFaults, kUnits> active_{};
  int last_id_ = 0;
};

}  // namespace stationd::plant

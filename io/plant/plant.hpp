// Plant: the cell's physics (docs/cell.md) in fixed time steps, repeatable from a seed; ledger, faults.
// Owned by its user: a test, SharedPlant, plantsim.
// One thread at a time; no clock, no I/O, no threads of its own.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "io/plant/faults.hpp"
#include "io/plant/ledger.hpp"
#include "io/plant/track.hpp"
#include "io/plant/types.hpp"

namespace stationd::plant {

class Plant {
 public:
  /// Throws std::invalid_argument for a configuration that cannot be (no types, step out of range).
  explicit Plant(PlantConfig config = {});

  // --- the units, as a controller sees them ---
  /// Unit 1..4; asserts otherwise. Coils and holding registers may be written at any time between steps and
  /// act from the next step on.
  UnitIo& unit(int number) noexcept;
  const UnitIo& unit(int number) const noexcept;
  /// Tells the unit's watchdog (PlantConfig::watchdog_ns) that something was written to it.
  void note_write(int unit) noexcept;
  /// Drops all coils but gripper_close, as the unit's watchdog does.
  void de_energise(int unit) noexcept;

  // --- time ---
  std::int64_t now_ns() const noexcept { return now_ns_; }
  std::int64_t step_ns() const noexcept { return config_.step_ns; }
  /// Advances by one step.
  void step();
  /// Steps while the next step does not go past `until_ns`.
  void advance_to(std::int64_t until_ns);

  // --- faults; a fault acts from the next step on ---
  /// Throws std::invalid_argument for a unit, index or value that is not there. The result is for clear().
  int inject(const Fault& fault);
  void clear(int id) noexcept;
  void clear_faults() noexcept;

  // --- the operator's hands; each acts at once; false when there was nothing to do ---
  /// Takes what the gripper holds (part or piece) out of it. A piece so removed counts as removed, not as
  /// missing.
  bool operator_removes_from_gripper(int unit);
  /// Takes the pallet, with what is on it, out of a zone of the unit (outfeed: unit 4). Its piece counts as
  /// removed.
  bool operator_removes_pallet(int unit, Zone zone);
  /// Takes a part, and what is on it, off the pallet in position.
  bool operator_removes_part(int unit, Part lowest);
  /// Clears arm_jammed_between of the unit and leads the arm home, up.
  bool operator_frees_arm(int unit);
  /// Fills all magazines (storage: empties the shelves) of the unit.
  void operator_refills(int unit);
  /// Sets what a magazine holds (storage: places free), feeder 0-based from arm position 3.
  void operator_sets_level(int unit, std::size_t feeder, std::uint16_t level);

  // --- what is really there, for judging ---
  const Ledger& ledger() const noexcept { return ledger_; }
  const Station& station(int unit) const noexcept;
  /// Number of the pallet in a zone, 0: none.
  std::uint32_t pallet_in(int unit, Zone zone) const noexcept;
  /// Pallets that the infeed gave so far.
  std::uint32_t pallets_entered() const noexcept { return entered_; }

  // --- save and load, so that the plant outlives the process that models it ---
  /// Everything but the configuration and the faults, as text with a checksum.
  std::string save() const;
  /// Restores what save() gave from a plant of the same configuration; the units come up with their coils
  /// dropped, all but gripper_close. Throws std::runtime_error naming what is wrong; the plant is then
  /// unchanged.
  void load(std::string_view text);

 private:
  void step_infeed();
  void step_outfeed();
  void step_watchdogs();
  void step_once_faults();
  void step_operator(Station& station, const UnitFaults& faults);
  void refresh_inputs() noexcept;
  bool take_pallet(TrackSlot& slot);
  bool take_held(Station& station);
  bool take_part_off(Pallet& pallet, std::size_t lowest);
  template <class Archive> void visit(Archive& archive);

  PlantConfig config_;
  Ledger ledger_;
  FaultTable faults_;
  std::array<Station, kUnits> stations_;
  TrackSlot outfeed_;
  std::int64_t now_ns_ = 0;
  std::int64_t infeed_wait_ns_ = 0;
  std::uint64_t random_ = 0;
  std::uint32_t entered_ = 0;
};

}  // namespace stationd::plant

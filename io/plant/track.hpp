// Station: one station's machinery: track, stoppers, clamp, arm, gripper, press, reader, magazines.
// Owned by its Plant; the controller's program sees only its UnitIo.
// The thread that steps the plant.
#pragma once

#include <array>
#include <cstdint>

#include "io/plant/faults.hpp"
#include "io/plant/ledger.hpp"
#include "io/plant/types.hpp"

namespace stationd::plant {

/// A pallet with what is on it.
struct Pallet {
  std::uint32_t number = 0;  ///< of its PalletRecord; 0: no pallet
  std::uint32_t code = 0;
  std::array<std::uint8_t, kParts> variant{};  ///< by Part; 0: seat free
  std::int64_t pressed_ns = 0;                 ///< how long the lid has been held down without a break
  bool seated = false;

  bool has(Part part) const noexcept { return variant[static_cast<std::size_t>(part)] != 0; }
  bool loaded() const noexcept { return has(Part::base); }
};

/// One zone of the track: a pallet or none, and how far the belt has carried it through the zone.
struct TrackSlot {
  Pallet pallet;
  std::int64_t travel_ns = 0;

  bool taken() const noexcept { return pallet.number != 0; }
};

/// What moves between two ends in a fixed time: 0 is the de-energised end (closed, open, up).
struct Axis {
  std::int64_t at_ns = 0;
  std::int64_t full_ns = 1;

  void move(bool to_far_end, std::int64_t by_ns) noexcept {
    at_ns = to_far_end ? (at_ns + by_ns < full_ns ? at_ns + by_ns : full_ns)
                       : (at_ns > by_ns ? at_ns - by_ns : 0);
  }
  bool at_start() const noexcept { return at_ns == 0; }
  bool at_end() const noexcept { return at_ns == full_ns; }
  bool past_half() const noexcept { return 2 * at_ns >= full_ns; }
};

enum class Grip : std::uint8_t { nothing, part, piece };

/// What the gripper holds: one part (robot, loader, sealer) or a whole piece with its history (storage).
struct Held {
  Grip grip = Grip::nothing;
  Part part = Part::base;
  std::uint8_t variant = 0;
  Pallet piece;  ///< storage: the number, code, parts of the piece
};

/// A magazine (or, in storage, a shelf: `level` is then the places free).
struct Feeder {
  std::uint16_t level = 0;
  std::int64_t low_for_ns = 0;  ///< how long the operator could have seen it low
  Pallet at_place;  ///< storage: the piece at the place under the arm; the shelf moves on when the arm leaves
};

class Station {
 public:
  /// What a step needs from around the station.
  struct Surroundings {
    const PlantConfig& config;
    Ledger& ledger;
    const UnitFaults& faults;
    TrackSlot& next;  ///< the next station's entry zone, or the outfeed
    std::int64_t now_ns;
  };

  void set_up(int unit, const PlantConfig& config);
  /// One step of the plant. Stations are stepped from the last to the first.
  void step(const Surroundings& around);
  /// Shows the physical state at the discrete inputs and input registers.
  void refresh_inputs(const UnitFaults& faults, bool next_clear) noexcept;
  /// The operator leads the arm home, up.
  void bring_arm_home() noexcept;

  bool is_loader() const noexcept { return unit_ == 1; }
  bool is_sealer() const noexcept { return unit_ == 3; }
  bool is_storage() const noexcept { return unit_ == 4; }
  std::size_t feeder_count() const noexcept { return unit_ == 2 ? 4 : 2; }
  std::uint16_t positions() const noexcept { return static_cast<std::uint16_t>(2 + feeder_count()); }
  /// Arm position reached, 0 between positions or while moving.
  std::uint16_t arm_position() const noexcept;
  TrackSlot& slot(Zone zone) noexcept;

  template <class Archive> void visit(Archive& archive);

  // The plant and tests read these; only the plant changes them.
  UnitIo io;
  TrackSlot entry, transfer, position;
  Axis entry_stopper, stopper, clamp, arm_height, gripper, press;
  Held held;
  std::array<Feeder, 4> feeders;
  std::int64_t arm_at_ns = 0;      ///< sideways; position p is at (p - 1) * pitch
  std::int64_t reading_ns = 0;     ///< how long the reader has looked at the pallet in position
  std::int64_t unwritten_ns = -1;  ///< since the last write to the unit; -1: none yet

 private:
  bool on(std::size_t coil, const UnitFaults& faults) const noexcept {
    return io.coils[coil] && !faults.jammed(coil);
  }
  void flag(const Surroundings& around, ViolationKind kind, bool now) noexcept;
  void step_track(const Surroundings& around);
  void step_arriving(const Surroundings& around);
  void step_leaving(const Surroundings& around, bool belt);
  void step_axes(const Surroundings& around);
  void step_arm(const Surroundings& around);
  void step_gripper(const Surroundings& around);
  void step_press(const Surroundings& around);
  void step_reader(const Surroundings& around);
  void judge_interlocks(const Surroundings& around);
  void leave_shelf() noexcept;
  void show_stuck(const UnitFaults& faults) noexcept;
  void grip(const Surroundings& around);
  void grip_piece(const Surroundings& around, std::uint16_t at);
  void release(const Surroundings& around);
  void place_part(const Surroundings& around);
  bool store_piece(const Surroundings& around, std::uint16_t at);
  bool arm_over_pallet() const noexcept;

  int unit_ = 0;
  std::int64_t pitch_ns_ = 1;
  std::int64_t entry_full_ns_ = 0;
  std::uint32_t flagged_ = 0;  ///< violations that last, by kind
  std::uint32_t code_shown_ = 0;
  bool arm_moving_ = false;
  bool crowded_ = false;  ///< in this step a pallet was driven into a zone that is taken
};

}  // namespace stationd::plant

// Arm: the pick-and-place arm as a sub-sequence: fetches one part (or piece) and puts it down, one errand
// at a time.
// Owned by a program, which gives it inputs, permits and time and passes its outputs on.
// The scan thread; plain values, nothing here allocates.
#pragma once

#include <cstdint>
#include <string_view>

#include "programs/piece_types.hpp"
#include "scan/nonblocking.hpp"

namespace stationd::programs {

inline constexpr std::uint16_t kArmHome = 1;
inline constexpr std::uint16_t kArmOverPallet = 2;
inline constexpr std::uint16_t kArmFirstFeeder = 3;

/// One thing to carry. Positions as docs/cell.md numbers them.
struct Errand {
  Kind kind = Kind::none;
  std::uint8_t variant = 0;
  std::uint16_t from = 0;
  std::uint16_t to = 0;
  bool none() const noexcept { return kind == Kind::none; }
  bool operator==(const Errand&) const = default;
};

struct ArmInputs {
  bool up = false, down = false;
  bool gripper_open = false, gripper_closed = false;
  bool part = false;
  std::uint16_t position = 0;
};

/// What the arm may do in this scan, and what the program knows for it.
struct ArmPermits {
  Errand errand;        ///< what is wanted next; none: nothing
  bool needed = false;  ///< the errand is for the piece in position: another part in the gripper is a fault
  bool lower = false;   ///< no pallet is being let out
  bool pick = false;    ///< there is a part at errand.from, and the arm may be lowered on it
  bool place = false;   ///< the part in the gripper is wanted now: it may be brought to its target
  bool lower_place = false;  ///< the target is free: the arm may be lowered there
  bool wait_place = false;   ///< the target is full: no time-out while it is
  bool placed = false;       ///< the part is seen at its target
  bool recorded = false;     ///< what asks() asked for is on disk
};

struct ArmOutputs {
  bool enable = false, down = false, close = false;
  std::uint16_t target = kArmHome;
};

/// Records that must be on disk before the arm goes on.
enum class Record : std::uint8_t {
  none,
  pick,   ///< before the gripper closes: what it is about to hold
  place,  ///< before it is brought to its target: that from now on it may have been put down
  placed  ///< before the arm leaves: that it was put down (pieces only: nothing else could tell later)
};

enum class ArmStep : std::uint8_t {
  raise = 50,
  open_empty,
  go_home,
  idle,
  to_source,
  wait_source,
  record_pick,
  lower_to_pick,
  grip,
  lift,
  hold,
  record_place,
  to_target,
  wait_target,
  lower_to_place,
  let_go,
  record_placed,
  rise,
  keep  ///< letting go failed: close again, so that nothing falls when the fault lifts the arm
};
inline constexpr std::uint32_t kArmStepFirst = 50, kArmStepLast = 68;

/// "arm: raise", ...; empty for a number that is no step.
std::string_view arm_step_name(std::uint32_t step) noexcept;

class Arm {
 public:
  /// After Start: begins by raising the arm. `held`: what the record says the gripper holds, none if it
  /// says nothing. The gripper stays as the sensors show it.
  void restart(const ArmInputs& in, const Errand& held, std::int64_t clock_ns) noexcept STATIOND_NONBLOCKING;

  /// One scan. Returns the code of a fault, 0 if there is none.
  std::uint32_t run(const ArmInputs& in, const ArmPermits& may, std::int64_t clock_ns,
                    std::int64_t timeout_ns) noexcept STATIOND_NONBLOCKING;

  /// The inputs were not to be seen for a while: what moved meanwhile is no fault.
  void look_away() noexcept { position_seen_ = 0; }

  const ArmOutputs& outputs() const noexcept { return out_; }
  ArmStep step() const noexcept { return step_; }
  Record asks() const noexcept { return asks_; }
  /// What is being fetched or held, none otherwise.
  const Errand& errand() const noexcept { return errand_; }
  /// Up, and staying so while `lower` is withheld: a pallet may pass.
  bool clear() const noexcept STATIOND_NONBLOCKING;
  /// Up at home or on its way there with nothing to do.
  bool resting() const noexcept { return step_ == ArmStep::idle || step_ == ArmStep::hold; }
  bool holding() const noexcept { return step_ >= ArmStep::lift && step_ <= ArmStep::let_go; }

 private:
  std::uint32_t advance(const ArmInputs& in, const ArmPermits& may) noexcept STATIOND_NONBLOCKING;
  std::uint32_t fetch(const ArmInputs& in, const ArmPermits& may) noexcept STATIOND_NONBLOCKING;
  std::uint32_t deliver(const ArmInputs& in, const ArmPermits& may) noexcept STATIOND_NONBLOCKING;
  std::uint32_t raised(const ArmInputs& in) noexcept STATIOND_NONBLOCKING;
  std::uint32_t check(const ArmInputs& in) const noexcept STATIOND_NONBLOCKING;
  std::uint32_t timed_out(const ArmInputs& in) const noexcept STATIOND_NONBLOCKING;
  bool waits(const ArmPermits& may) const noexcept STATIOND_NONBLOCKING;
  void drive() noexcept STATIOND_NONBLOCKING;
  void go(ArmStep step) noexcept STATIOND_NONBLOCKING;
  bool move(const ArmInputs& in, std::uint16_t target) noexcept STATIOND_NONBLOCKING;

  ArmStep step_ = ArmStep::raise;
  Errand errand_;
  ArmOutputs out_;
  Record asks_ = Record::none;
  std::uint16_t position_seen_ = 0;  // last position read, 0: between, or unknown
  std::uint32_t kept_fault_ = 0;     // raised when the gripper is closed again
  std::int64_t clock_ns_ = 0;
  std::int64_t entered_ns_ = 0;
};

}  // namespace stationd::programs

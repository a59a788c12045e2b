#include "programs/arm.hpp"

#include "scan/codes.hpp"

namespace stationd::programs {
namespace {

// A switch counts only when its opposite agrees: a stuck one stops the arm instead of crashing it.
constexpr std::int64_t kKeep_ns =
    100'000'000;  // for the command to reach the gripper before the fault cuts it off

bool is_up(const ArmInputs& in) noexcept { return in.up && !in.down; }
bool is_down(const ArmInputs& in) noexcept { return in.down && !in.up; }

}  // namespace

std::string_view arm_step_name(std::uint32_t step) noexcept {
  if (step < kArmStepFirst || step > kArmStepLast) return {};
  switch (static_cast<ArmStep>(step)) {
    case ArmStep::raise: return "arm: raise";
    case ArmStep::open_empty: return "arm: open the empty gripper";
    case ArmStep::go_home: return "arm: go home";
    case ArmStep::idle: return "arm: idle";
    case ArmStep::to_source: return "arm: go to fetch";
    case ArmStep::wait_source: return "arm: wait for a part";
    case ArmStep::record_pick: return "arm: record what is fetched";
    case ArmStep::lower_to_pick: return "arm: lower to fetch";
    case ArmStep::grip: return "arm: grip";
    case ArmStep::lift: return "arm: lift";
    case ArmStep::hold: return "arm: hold the part";
    case ArmStep::record_place: return "arm: record what is put down";
    case ArmStep::to_target: return "arm: go to put down";
    case ArmStep::wait_target: return "arm: wait for a free place";
    case ArmStep::lower_to_place: return "arm: lower to put down";
    case ArmStep::let_go: return "arm: let go";
    case ArmStep::record_placed: return "arm: record that it was put down";
    case ArmStep::rise: return "arm: rise";
    case ArmStep::keep: return "arm: close again";
  }
  return {};
}

void Arm::restart(const ArmInputs& in, const Errand& held, std::int64_t clock_ns) noexcept {
  clock_ns_ = clock_ns;
  errand_ = held;
  position_seen_ = 0;
  out_ = {};
  out_.close = in.part || !in.gripper_open;
  out_.target = in.position == 0 ? kArmHome : in.position;
  go(ArmStep::raise);
}

void Arm::go(ArmStep step) noexcept {
  step_ = step;
  entered_ns_ = clock_ns_;
  asks_ = step == ArmStep::record_pick     ? Record::pick
          : step == ArmStep::record_place  ? Record::place
          : step == ArmStep::record_placed ? Record::placed
                                           : Record::none;
}

bool Arm::clear() const noexcept {
  return step_ == ArmStep::idle || step_ == ArmStep::hold || step_ == ArmStep::go_home ||
         step_ == ArmStep::to_source || step_ == ArmStep::wait_source;
}

/// Sideways, while it is up; true on arrival. The drive is on only while the arm has to move: a position
/// that reads wrong then leaves the arm standing instead of moving on while it is lowered.
bool Arm::move(const ArmInputs& in, std::uint16_t target) noexcept {
  out_.target = target;
  out_.enable = in.position != target && is_up(in);
  return in.position == target && is_up(in);
}

std::uint32_t Arm::run(const ArmInputs& in, const ArmPermits& may, std::int64_t clock_ns,
                       std::int64_t timeout_ns) noexcept {
  clock_ns_ = clock_ns;
  if (const std::uint32_t wrong = check(in); wrong != 0) return wrong;
  position_seen_ = in.position;
  const ArmStep before = step_;
  out_.enable = false;
  if (const std::uint32_t wrong = advance(in, may); wrong != 0) return wrong;
  drive();
  if (waits(may)) entered_ns_ = clock_ns_;
  if (step_ != before || clock_ns_ - entered_ns_ <= timeout_ns) return 0;
  if (step_ != ArmStep::let_go || !in.part || in.gripper_open) return timed_out(in);
  kept_fault_ = timed_out(in);
  go(ArmStep::keep);
  drive();
  return 0;
}

/// What must be true in the step, at every moment.
std::uint32_t Arm::check(const ArmInputs& in) const noexcept {
  const bool carries = step_ >= ArmStep::lift && step_ <= ArmStep::lower_to_place;
  if (carries && !in.part) return errand_.kind == Kind::piece ? code::piece_lost : code::part_lost;
  const bool empty = step_ >= ArmStep::open_empty && step_ <= ArmStep::record_pick;
  if (empty && in.part) return code::gripper_unknown_part;
  const bool lowered = step_ == ArmStep::grip || step_ == ArmStep::let_go || step_ == ArmStep::record_placed;
  if (lowered && in.up) return code::end_switches_conflict;
  // Between two positions the reading is 0; the device is read several times on the way.
  if (position_seen_ != 0 && in.position != 0 && in.position != position_seen_) return code::arm_astray;
  const bool stands = (step_ >= ArmStep::lower_to_pick && step_ <= ArmStep::lift) ||
                      (step_ >= ArmStep::lower_to_place && step_ <= ArmStep::rise);
  if (stands && in.position != out_.target) return code::arm_astray;
  return 0;
}

std::uint32_t Arm::advance(const ArmInputs& in, const ArmPermits& may) noexcept {
  if (step_ >= ArmStep::hold) return deliver(in, may);
  if (step_ >= ArmStep::to_source) return fetch(in, may);
  switch (step_) {
    case ArmStep::raise: return is_up(in) ? raised(in) : 0;
    case ArmStep::open_empty:
      if (in.gripper_open && !in.gripper_closed) go(ArmStep::go_home);
      return 0;
    case ArmStep::go_home:
      if (may.needed && !may.errand.none())
        go(ArmStep::idle);
      else if (move(in, kArmHome))
        go(ArmStep::idle);
      return 0;
    default:  // idle
      if (may.errand.none()) {
        move(in, kArmHome);
        return 0;
      }
      errand_ = may.errand;
      go(ArmStep::to_source);
      return 0;
  }
}

/// The arm is up after Start: what does the gripper hold?
std::uint32_t Arm::raised(const ArmInputs& in) noexcept {
  if (in.part) {
    if (errand_.none()) return code::gripper_unknown_part;
    go(ArmStep::hold);
    return 0;
  }
  errand_ = {};
  go(in.gripper_open ? ArmStep::go_home : ArmStep::open_empty);
  return 0;
}

std::uint32_t Arm::fetch(const ArmInputs& in, const ArmPermits& may) noexcept {
  switch (step_) {
    case ArmStep::to_source:
    case ArmStep::wait_source:
      if (may.errand != errand_) {
        errand_ = {};
        go(ArmStep::go_home);
      } else if (!move(in, errand_.from)) {
        break;
      } else if (step_ == ArmStep::to_source) {
        go(ArmStep::wait_source);
      } else if (may.pick && may.lower) {
        go(ArmStep::record_pick);
      }
      break;
    case ArmStep::record_pick:
      if (may.recorded && may.lower) go(ArmStep::lower_to_pick);
      break;
    case ArmStep::lower_to_pick:
      if (is_down(in)) go(ArmStep::grip);
      break;
    case ArmStep::grip:
      if (in.part && in.gripper_closed) go(ArmStep::lift);
      break;
    default:  // lift
      if (is_up(in)) go(ArmStep::hold);
      break;
  }
  return 0;
}

std::uint32_t Arm::deliver(const ArmInputs& in, const ArmPermits& may) noexcept {
  switch (step_) {
    case ArmStep::hold:
      if (may.needed && (may.errand.kind != errand_.kind || may.errand.variant != errand_.variant))
        return code::gripper_wrong_part;
      if (may.place)
        go(ArmStep::record_place);
      else if (errand_.kind != Kind::piece)
        move(in, kArmHome);
      break;
    case ArmStep::record_place:
      if (may.recorded) go(ArmStep::to_target);
      break;
    case ArmStep::to_target:
      if (move(in, errand_.to)) go(ArmStep::wait_target);
      break;
    case ArmStep::wait_target:
      if (may.lower_place && may.lower) go(ArmStep::lower_to_place);
      break;
    case ArmStep::lower_to_place:
      if (is_down(in)) go(ArmStep::let_go);
      break;
    case ArmStep::let_go:
      if (in.gripper_open && !in.gripper_closed && !in.part && may.placed)
        go(errand_.kind == Kind::piece ? ArmStep::record_placed : ArmStep::rise);
      break;
    case ArmStep::record_placed:
      if (may.recorded) go(ArmStep::rise);
      break;
    case ArmStep::keep:
      if (in.gripper_closed && clock_ns_ - entered_ns_ > kKeep_ns) return kept_fault_;
      break;
    default:  // rise
      if (!is_up(in)) break;
      errand_ = {};
      go(ArmStep::go_home);
      break;
  }
  return 0;
}

/// Height and gripper follow from the step alone; sideways is move()'s.
void Arm::drive() noexcept {
  out_.down = step_ == ArmStep::lower_to_pick || step_ == ArmStep::grip || step_ == ArmStep::lower_to_place ||
              step_ == ArmStep::let_go || step_ == ArmStep::record_placed || step_ == ArmStep::keep;
  if (step_ == ArmStep::raise) return;  // the gripper stays as it was found
  out_.close = (step_ >= ArmStep::grip && step_ <= ArmStep::lower_to_place) || step_ == ArmStep::keep;
}

/// Steps that wait for something that is not the arm's to bring about have no time-out.
bool Arm::waits(const ArmPermits& may) const noexcept {
  if (step_ == ArmStep::idle || step_ == ArmStep::hold) return true;
  if (step_ == ArmStep::wait_source) return !may.pick || !may.lower;
  if (step_ == ArmStep::wait_target) return may.wait_place || !may.lower;
  return step_ == ArmStep::record_pick && !may.lower;
}

std::uint32_t Arm::timed_out(const ArmInputs& in) const noexcept {
  switch (step_) {
    case ArmStep::raise:
    case ArmStep::lower_to_pick:
    case ArmStep::lift:
    case ArmStep::lower_to_place:
    case ArmStep::rise: return code::arm_height_jammed;
    case ArmStep::open_empty: return code::gripper_jammed;
    case ArmStep::go_home:
    case ArmStep::to_source:
    case ArmStep::to_target: return is_up(in) ? code::arm_sideways_jammed : code::arm_height_jammed;
    case ArmStep::record_pick:
    case ArmStep::record_place:
    case ArmStep::record_placed: return code::record_not_saved;
    case ArmStep::grip: return in.gripper_closed ? code::pick_failed : code::gripper_jammed;
    case ArmStep::let_go: return in.gripper_open ? code::place_failed : code::gripper_jammed;
    case ArmStep::wait_target: return code::place_taken;
    case ArmStep::keep: return kept_fault_;
    default: return code::step_timeout;
  }
}

}  // namespace stationd::programs

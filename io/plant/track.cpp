#include "io/plant/track.hpp"

#include <algorithm>
#include <cstdlib>

namespace stationd::plant {

void Station::set_up(int unit, const PlantConfig& config) {
  unit_ = unit;
  const MotionTimes& times = config.times;
  pitch_ns_ = times.arm_pitch_ns;
  entry_full_ns_ = times.entry_ns;
  entry_stopper.full_ns = times.entry_stopper_ns;
  stopper.full_ns = times.stopper_ns;
  clamp.full_ns = times.clamp_ns;
  arm_height.full_ns = times.arm_height_ns;
  gripper.full_ns = times.gripper_ns;
  press.full_ns = times.press_ns;
  for (std::size_t i = 0; i < feeder_count(); ++i) {
    feeders[i].level = is_storage() ? config.shelf_capacity : config.magazine_capacity;
  }
}

TrackSlot& Station::slot(Zone zone) noexcept {
  return zone == Zone::entry ? entry : zone == Zone::transfer ? transfer : position;
}

std::uint16_t Station::arm_position() const noexcept {
  if (arm_moving_ || arm_at_ns % pitch_ns_ != 0) return 0;
  return static_cast<std::uint16_t>(arm_at_ns / pitch_ns_ + 1);
}

bool Station::arm_over_pallet() const noexcept {
  const std::int64_t over = pitch_ns_ * (arm::over_pallet - 1);
  return arm_at_ns > over - pitch_ns_ && arm_at_ns < over + pitch_ns_;
}

void Station::bring_arm_home() noexcept {
  leave_shelf();
  arm_at_ns = 0;
  arm_height.at_ns = 0;
}

void Station::flag(const Surroundings& around, ViolationKind kind, bool now) noexcept {
  const std::uint32_t bit = 1U << static_cast<unsigned>(kind);
  if (now && (flagged_ & bit) == 0) around.ledger.violate(kind, unit_, position.pallet.number, around.now_ns);
  flagged_ = now ? flagged_ | bit : flagged_ & ~bit;
}

void Station::step(const Surroundings& around) {
  step_track(around);
  step_axes(around);
  step_arm(around);
  step_gripper(around);
  if (is_sealer()) step_press(around);
  step_reader(around);
  judge_interlocks(around);
}

void Station::step_track(const Surroundings& around) {
  crowded_ = false;
  const bool belt = on(co::conveyor, around.faults);
  step_leaving(around, belt);
  if (belt) step_arriving(around);
  flag(around, ViolationKind::two_pallets_in_zone, crowded_);
}

void Station::step_arriving(const Surroundings& around) {
  const std::int64_t dt = around.config.step_ns;
  const MotionTimes& times = around.config.times;
  if (transfer.taken()) {
    transfer.travel_ns = std::min(transfer.travel_ns + dt, times.transfer_ns);
    // A pallet that finds the position taken, or the clamp in its way, waits there with the belt slipping
    // under it.
    if (transfer.travel_ns == times.transfer_ns && !position.taken() && clamp.at_start()) {
      position = {transfer.pallet, 0};
      transfer = {};
      reading_ns = 0;
    }
  }
  if (!entry.taken()) return;
  entry.travel_ns = std::min(entry.travel_ns + dt, times.entry_ns);
  if (entry.travel_ns < times.entry_ns || !entry_stopper.at_end()) return;
  crowded_ = crowded_ || transfer.taken();
  if (transfer.taken()) return;
  transfer = {entry.pallet, 0};
  entry = {};
}

void Station::step_leaving(const Surroundings& around, bool belt) {
  const bool driven = belt && stopper.at_end() && position.taken();
  const bool clamped = driven && clamp.past_half();
  const bool under_arm = driven && arm_position() == arm::over_pallet && !arm_height.at_start();
  const bool under_press = driven && !press.at_start();
  flag(around, ViolationKind::clamp_holds_moving_pallet, clamped);
  flag(around, ViolationKind::arm_holds_moving_pallet, under_arm);
  flag(around, ViolationKind::press_holds_moving_pallet, under_press);
  if (!driven || under_arm || under_press || !clamp.at_start()) {
    position.travel_ns = 0;
    return;
  }
  position.travel_ns += around.config.step_ns;
  if (position.travel_ns < around.config.times.leave_ns) return;
  crowded_ = around.next.taken();
  if (around.next.taken()) return;
  around.next = {position.pallet, 0};
  position = {};
}

void Station::step_axes(const Surroundings& around) {
  const std::int64_t dt = around.config.step_ns;
  const UnitFaults& faults = around.faults;
  if (!faults.jammed(co::entry_stopper_open)) entry_stopper.move(io.coils[co::entry_stopper_open], dt);
  if (!faults.jammed(co::stopper_open)) stopper.move(io.coils[co::stopper_open], dt);
  if (!faults.jammed(co::clamp_close)) clamp.move(io.coils[co::clamp_close], dt);
  if (!faults.jammed(co::arm_down)) arm_height.move(io.coils[co::arm_down], dt);
  if (is_sealer() && !faults.jammed(co::press_down)) press.move(io.coils[co::press_down], dt);
}

void Station::step_arm(const Surroundings& around) {
  const std::uint16_t target = io.holding_registers[hr::arm_target];
  const std::int64_t goal_ns = (std::int64_t{target} - 1) * pitch_ns_;
  const bool wanted =
      io.coils[co::arm_enable] && target >= 1 && target <= positions() && goal_ns != arm_at_ns;
  arm_moving_ = false;
  // A lowered arm stays where it is: the crash is in the ledger, the model goes on.
  flag(around, ViolationKind::arm_sideways_while_down, wanted && !arm_height.at_start());
  if (!wanted || !arm_height.at_start() || around.faults.jammed(co::arm_enable)) return;
  if (around.faults.arm_jammed && arm_at_ns % pitch_ns_ != 0) return;
  if (arm_at_ns % pitch_ns_ == 0) leave_shelf();
  const std::int64_t dt = std::min(around.config.step_ns, std::abs(goal_ns - arm_at_ns));
  arm_at_ns += goal_ns > arm_at_ns ? dt : -dt;
  arm_moving_ = arm_at_ns != goal_ns;
}

void Station::leave_shelf() noexcept {
  // The shelf brings its next free place under the arm's position while the arm is away.
  for (Feeder& feeder : feeders) feeder.at_place = {};
}

void Station::step_gripper(const Surroundings& around) {
  if (around.faults.jammed(co::gripper_close)) return;
  const bool was_closed = gripper.at_end();
  gripper.move(io.coils[co::gripper_close], around.config.step_ns);
  if (held.grip != Grip::nothing) {
    if (!gripper.past_half()) release(around);
  } else if (gripper.at_end() && !was_closed && arm_height.at_end()) {
    grip(around);
  }
}

void Station::grip(const Surroundings& around) {
  const std::uint16_t at = arm_position();
  if (is_storage()) return grip_piece(around, at);
  if (at < arm::feeder_first) return;
  const auto index = static_cast<std::size_t>(at - arm::feeder_first);
  if (feeders[index].level == 0) return;
  --feeders[index].level;
  const Part part = unit_ == 1   ? Part::base
                    : unit_ == 3 ? Part::lid
                    : index < 2  ? Part::bearing
                                 : Part::shaft;
  held = {Grip::part, part, static_cast<std::uint8_t>(index % 2 + 1), {}};
}

void Station::grip_piece(const Surroundings& around, std::uint16_t at) {
  if (at == arm::over_pallet && position.pallet.loaded()) {
    held = {Grip::piece, Part::base, 0, position.pallet};
    position.pallet.variant = {};
    around.ledger.record(position.pallet.number).picked_ns = around.now_ns;
  } else if (at >= arm::feeder_first) {
    Feeder& shelf = feeders[static_cast<std::size_t>(at - arm::feeder_first)];
    if (shelf.at_place.number == 0) return;
    held = {Grip::piece, Part::base, 0, shelf.at_place};
    around.ledger.record(shelf.at_place.number).shelf = 0;
    shelf.at_place = {};
    ++shelf.level;
  }
}

void Station::release(const Surroundings& around) {
  // Below half-way a part slides into its place: a Stop that lifts the arm while the gripper opens drops
  // nothing.
  const std::uint16_t at = arm_height.past_half() ? arm_position() : std::uint16_t{0};
  if (held.grip == Grip::piece) {
    if (!store_piece(around, at)) {
      around.ledger.violate(ViolationKind::gripper_opened_astray, unit_, held.piece.number, around.now_ns);
      around.ledger.record(held.piece.number).dropped_ns = around.now_ns;
    }
  } else if (at == arm::over_pallet && position.taken()) {
    place_part(around);
  } else {
    around.ledger.violate(ViolationKind::gripper_opened_astray, unit_, position.pallet.number, around.now_ns);
    around.ledger.part_dropped();
  }
  held = {};
}

bool Station::store_piece(const Surroundings& around, std::uint16_t at) {
  if (at < arm::feeder_first) return false;
  Feeder& shelf = feeders[static_cast<std::size_t>(at - arm::feeder_first)];
  if (shelf.level == 0 || shelf.at_place.number != 0) return false;
  --shelf.level;
  shelf.at_place = held.piece;
  PalletRecord& record = around.ledger.record(held.piece.number);
  record.stored_ns = around.now_ns;
  record.shelf = static_cast<std::uint8_t>(at - arm::feeder_first + 1);
  ++record.times_stored;
  return true;
}

void Station::place_part(const Surroundings& around) {
  Pallet& pallet = position.pallet;
  PalletRecord& record = around.ledger.record(pallet.number);
  const auto seat = static_cast<std::size_t>(held.part);
  if (pallet.variant[seat] != 0) {
    around.ledger.violate(ViolationKind::seat_taken, unit_, pallet.number, around.now_ns);
    ++record.doubles;
    return;
  }
  if (seat > 0 && pallet.variant[seat - 1] == 0) {
    around.ledger.violate(ViolationKind::wrong_order, unit_, pallet.number, around.now_ns);
    around.ledger.part_dropped();
    return;
  }
  pallet.variant[seat] = held.variant;
  record.variant[seat] = held.variant;
  record.placed_ns[seat] = around.now_ns;
}

void Station::step_press(const Surroundings& around) {
  Pallet& pallet = position.pallet;
  if (pallet.number == 0 || pallet.seated) return;
  if (!press.at_end() || !clamp.past_half() || !pallet.has(Part::lid)) {
    pallet.pressed_ns = 0;
    return;
  }
  pallet.pressed_ns += around.config.step_ns;
  const PieceType* type = around.ledger.type_of(pallet.code);
  if (type != nullptr && pallet.pressed_ns < type->press_ns) return;
  pallet.seated = true;
  around.ledger.record(pallet.number).seated_ns = around.now_ns;
}

void Station::step_reader(const Surroundings& around) {
  const bool sees = position.taken() && on(co::read_code, around.faults) && !around.faults.code_unreadable;
  reading_ns = sees ? std::min(reading_ns + around.config.step_ns, around.config.times.code_read_ns) : 0;
  const bool valid = sees && reading_ns == around.config.times.code_read_ns;
  code_shown_ = !valid ? 0 : around.faults.code_wrong ? around.faults.code : position.pallet.code;
}

void Station::judge_interlocks(const Surroundings& around) {
  // Judged by what is commanded: when all coils drop at once the arm rises while the clamp opens, which is no
  // fault.
  const bool lowering = io.coils[co::arm_down] && !arm_height.at_start();
  flag(around, ViolationKind::arm_down_clamp_open,
       lowering && arm_position() == arm::over_pallet && !clamp.past_half());
  if (!is_sealer()) return;
  flag(around, ViolationKind::press_down_arm_in_way, !press.at_start() && arm_over_pallet());
  flag(around, ViolationKind::press_down_clamp_open,
       io.coils[co::press_down] && !press.at_start() && !clamp.past_half());
}

namespace {
void put(UnitIo& io, std::size_t index, bool value) noexcept { io.discrete_inputs[index] = value; }
}  // namespace

void Station::refresh_inputs(const UnitFaults& faults, bool next_clear) noexcept {
  put(io, di::pallet_at_entry, entry.taken() && entry.travel_ns >= entry_full_ns_);
  put(io, di::pallet_in_transfer, transfer.taken());
  put(io, di::pallet_in_position, position.taken());
  put(io, di::next_entry_clear, next_clear);
  put(io, di::entry_stopper_is_open, entry_stopper.at_end());
  put(io, di::entry_stopper_is_closed, entry_stopper.at_start());
  put(io, di::stopper_is_open, stopper.at_end());
  put(io, di::stopper_is_closed, stopper.at_start());
  put(io, di::clamp_is_closed, clamp.at_end());
  put(io, di::clamp_is_open, clamp.at_start());
  put(io, di::arm_is_up, arm_height.at_start());
  put(io, di::arm_is_down, arm_height.at_end());
  put(io, di::gripper_is_open, gripper.at_start());
  put(io, di::gripper_is_closed, gripper.at_end());
  put(io, di::part_in_gripper, held.grip != Grip::nothing);
  put(io, di::code_valid, code_shown_ != 0);
  const Pallet& pallet = position.pallet;
  const std::uint16_t at = arm_position();
  put(io, 16, unit_ == 2 ? pallet.has(Part::bearing) : is_sealer() ? pallet.has(Part::lid) : pallet.loaded());
  if (unit_ == 2) put(io, di::shaft_present, pallet.has(Part::shaft));
  if (is_sealer()) {
    put(io, di::press_is_up, press.at_start());
    put(io, di::press_is_down, press.at_end());
    put(io, di::lid_seated, pallet.seated);
  }
  if (is_storage()) {
    const bool at_shelf = at >= arm::feeder_first;
    const Feeder& shelf = feeders[at_shelf ? static_cast<std::size_t>(at - arm::feeder_first) : 0];
    put(io, di::place_occupied, at_shelf && (shelf.at_place.number != 0 || shelf.level == 0));
  }
  io.input_registers[ir::pallet_code_high] = static_cast<std::uint16_t>(code_shown_ >> 16);
  io.input_registers[ir::pallet_code_low] = static_cast<std::uint16_t>(code_shown_ & 0xFFFF);
  io.input_registers[ir::arm_position] = at;
  for (std::size_t i = 0; i < feeder_count(); ++i) io.input_registers[ir::level_first + i] = feeders[i].level;
  if (faults.stuck_mask != 0 || faults.register_mask != 0) show_stuck(faults);
}

void Station::show_stuck(const UnitFaults& faults) noexcept {
  for (std::size_t i = 0; i < kDiscreteInputs; ++i) {
    if (((faults.stuck_mask >> i) & 1U) != 0) put(io, i, ((faults.stuck_value >> i) & 1U) != 0);
  }
  for (std::size_t i = 0; i < kInputRegisters; ++i) {
    if (((faults.register_mask >> i) & 1U) != 0) io.input_registers[i] = faults.register_value[i];
  }
}

}  // namespace stationd::plant

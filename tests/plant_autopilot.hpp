// Autopilot: drives a plant's four units by their Modbus tables, as plainly as can be; no station program.
// Owned by a test.
// The test's thread.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "io/plant/plant.hpp"

namespace stationd::plant::test {

/// One station's sequence: each step sets coils, then waits for its condition. Starts over at the end.
class Sequence {
 public:
  struct Step {
    std::function<void(UnitIo&)> act;
    std::function<bool(const UnitIo&)> done;
  };
  Sequence(int unit, std::vector<Step> steps) : unit_(unit), steps_(std::move(steps)) {}

  void poll(Plant& plant) {
    UnitIo& io = plant.unit(unit_);
    if (!acted_) steps_[at_].act(io);
    acted_ = true;
    if (!steps_[at_].done(io)) return;
    at_ = (at_ + 1) % steps_.size();
    acted_ = false;
    rounds_ += at_ == 0;
  }
  int rounds() const noexcept { return rounds_; }

 private:
  int unit_;
  std::vector<Step> steps_;
  std::size_t at_ = 0;
  bool acted_ = false;
  int rounds_ = 0;
};

class Steps {
 public:
  Steps& on(std::size_t coil, std::size_t input) { return set(coil, true, input); }
  Steps& off(std::size_t coil, std::size_t input) { return set(coil, false, input); }
  Steps& await(std::size_t input, bool value) {
    steps_.push_back({[](UnitIo&) {}, [=](const UnitIo& io) { return io.discrete_inputs[input] == value; }});
    return *this;
  }
  Steps& move(const std::function<std::uint16_t(const UnitIo&)>& target) {
    const auto act = [=](UnitIo& io) {
      io.coils[co::arm_enable] = true;
      io.holding_registers[hr::arm_target] = target(io);
    };
    const auto done = [](const UnitIo& io) {
      return io.input_registers[ir::arm_position] == io.holding_registers[hr::arm_target];
    };
    steps_.push_back({act, done});
    return *this;
  }
  Steps& move(std::uint16_t target) {
    return move([=](const UnitIo&) { return target; });
  }
  /// A pallet from the entry into position, clamped, its code read.
  Steps& take_in() {
    on(co::conveyor, di::pallet_at_entry).on(co::entry_stopper_open, di::pallet_in_transfer);
    off(co::entry_stopper_open, di::entry_stopper_is_closed).await(di::pallet_in_position, true);
    return on(co::clamp_close, di::clamp_is_closed).on(co::read_code, di::code_valid);
  }
  Steps& give_away() {
    off(co::clamp_close, di::clamp_is_open).await(di::next_entry_clear, true);
    on(co::stopper_open, di::stopper_is_open).await(di::pallet_in_position, false);
    return off(co::stopper_open, di::stopper_is_closed);
  }
  Steps& grip() {
    return on(co::arm_down, di::arm_is_down)
        .on(co::gripper_close, di::gripper_is_closed)
        .off(co::arm_down, di::arm_is_up);
  }
  Steps& release() {
    return on(co::arm_down, di::arm_is_down)
        .off(co::gripper_close, di::gripper_is_open)
        .off(co::arm_down, di::arm_is_up);
  }
  /// One part of the pallet's type, from a feeder onto the pallet.
  Steps& fetch(Part part, std::uint16_t first_feeder) {
    return move([=](const UnitIo& io) { return feeder_of(io, part, first_feeder); })
        .grip()
        .move(arm::over_pallet)
        .release();
  }
  Sequence of(int unit) const { return {unit, steps_}; }

 private:
  static std::uint16_t feeder_of(const UnitIo& io, Part part, std::uint16_t first) {
    for (const PieceType& type : PlantConfig::default_types()) {
      if (type.code != io.pallet_code()) continue;
      return static_cast<std::uint16_t>(first + type.variant[static_cast<std::size_t>(part)] - 1);
    }
    return first;
  }
  Steps& set(std::size_t coil, bool value, std::size_t input) {
    steps_.push_back({[=](UnitIo& io) { io.coils[coil] = value; },
                      [=](const UnitIo& io) { return io.discrete_inputs[input]; }});
    return *this;
  }
  std::vector<Sequence::Step> steps_;
};

/// What a station does with a pallet between take_in() and give_away(), appended to `steps`.
inline Steps& work(Steps& steps, int unit) {
  if (unit == 1) return steps.fetch(Part::base, 3).move(arm::home);
  if (unit == 2) return steps.fetch(Part::bearing, 3).fetch(Part::shaft, 5).move(arm::home);
  if (unit == 3) {
    steps.fetch(Part::lid, 3).move(arm::home);
    return steps.on(co::press_down, di::lid_seated).off(co::press_down, di::press_is_up);
  }
  steps.move(arm::over_pallet).grip();
  steps.move([](const UnitIo& io) { return static_cast<std::uint16_t>(io.pallet_code() == 102 ? 4 : 3); });
  return steps.release().move(arm::home);
}

inline Sequence whole_sequence(int unit) {
  Steps steps;
  return work(steps.take_in(), unit).give_away().of(unit);
}

class Autopilot {
 public:
  Autopilot() {
    for (int unit = 1; unit <= kUnits; ++unit) sequences_.push_back(whole_sequence(unit));
  }
  void poll(Plant& plant) {
    for (Sequence& sequence : sequences_) sequence.poll(plant);
  }
  /// One poll before each step, as a controller with the plant's own period would.
  void run(Plant& plant, std::int64_t for_ns) {
    const std::int64_t until_ns = plant.now_ns() + for_ns;
    while (plant.now_ns() < until_ns) {
      poll(plant);
      plant.step();
    }
  }

 private:
  std::vector<Sequence> sequences_;
};

/// A plant under a test's hands.
class Rig {
 public:
  explicit Rig(PlantConfig config = one_type(101)) : plant(std::move(config)) {}

  static PlantConfig one_type(std::uint32_t code) {
    PlantConfig config;
    config.codes.assign(100, code);
    return config;
  }
  UnitIo& io(int unit) { return plant.unit(unit); }
  bool input(int unit, std::size_t index) { return plant.unit(unit).discrete_inputs[index]; }
  Verdict verdict() const { return plant.ledger().verdict(); }
  std::uint32_t count(ViolationKind kind) const { return plant.ledger().count(kind); }
  void run_ms(std::int64_t ms) { plant.advance_to(plant.now_ns() + ms * 1'000'000); }
  /// Sets a coil and lets the plant go on.
  void set(int unit, std::size_t coil, bool value, std::int64_t run_for_ms = 200) {
    io(unit).coils[coil] = value;
    run_ms(run_for_ms);
  }
  void move_arm(int unit, std::uint16_t target) {
    io(unit).coils[co::arm_enable] = true;
    io(unit).holding_registers[hr::arm_target] = target;
    run_ms(1000);
  }
  /// Plays a sequence to its end; false when that takes more than 20 s.
  bool play(Sequence sequence) {
    const std::int64_t limit_ns = plant.now_ns() + 20'000'000'000;
    while (sequence.rounds() == 0 && plant.now_ns() < limit_ns) {
      plant.step();
      sequence.poll(plant);
    }
    return sequence.rounds() == 1;
  }
  /// A pallet through the stations before `unit`, then clamped and read there.
  bool bring_to(int unit) {
    bool done = true;
    for (int before = 1; before < unit; ++before) done = done && play(whole_sequence(before));
    return done && play(Steps().take_in().of(unit));
  }
  /// A part from the feeder at `position` in the gripper, the arm over the pallet, up.
  bool fetch_from(int unit, std::uint16_t position) {
    return play(Steps().move(position).grip().move(arm::over_pallet).of(unit));
  }

  Plant plant;
};

}  // namespace stationd::plant::test

// The plant's violations, its injected faults and the operator's hands.
#include <doctest/doctest.h>

#include <stdexcept>
#include <string>

#include "io/plant/faults.hpp"
#include "io/plant/plant.hpp"
#include "tests/plant_autopilot.hpp"

using namespace stationd::plant;
using namespace stationd::plant::test;

namespace {

constexpr std::int64_t kMs = 1'000'000;

Fault fault(FaultKind kind, int unit, std::uint32_t index = 0, std::uint32_t value = 0) {
  Fault made;
  made.kind = kind;
  made.unit = unit;
  made.index = index;
  made.value = value;
  return made;
}

}  // namespace

// --- violations ---

TEST_CASE("Arm moved sideways while down is a violation, counted once, and does not move (IO-5)") {
  Rig rig;
  rig.set(1, co::arm_down, true);
  rig.move_arm(1, 3);
  CHECK(rig.count(ViolationKind::arm_sideways_while_down) == 1);
  CHECK(rig.io(1).input_registers[ir::arm_position] == arm::home);
  CHECK(rig.plant.ledger().violations()[0].unit == 1);
  CHECK(rig.plant.ledger().violations()[0].at_ns > 0);
}

TEST_CASE("Gripper opened with a part off the pallet is a violation and drops the part (IO-5)") {
  Rig rig;
  REQUIRE(rig.fetch_from(1, 3));
  rig.set(1, co::gripper_close, false);
  CHECK(rig.count(ViolationKind::gripper_opened_astray) == 1);
  CHECK(rig.verdict().dropped_parts == 1);
  CHECK_FALSE(rig.input(1, di::part_in_gripper));
}

TEST_CASE("Gripper opened with a piece off the shelf drops the piece (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(4));
  REQUIRE(rig.play(Steps().move(2).grip().move(1).of(4)));
  rig.set(4, co::gripper_close, false);
  CHECK(rig.count(ViolationKind::gripper_opened_astray) == 1);
  CHECK(rig.verdict().dropped_pieces == 1);
}

TEST_CASE("Part placed on a seat that is taken is a violation and a double (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  REQUIRE(rig.play(Steps().fetch(Part::base, 3).fetch(Part::base, 3).of(1)));
  CHECK(rig.count(ViolationKind::seat_taken) == 1);
  CHECK(rig.verdict().doubles == 1);
}

TEST_CASE("Part placed before the one below it is a violation (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(2));
  REQUIRE(rig.play(Steps().fetch(Part::shaft, 5).of(2)));
  CHECK(rig.count(ViolationKind::wrong_order) == 1);
  CHECK_FALSE(rig.input(2, di::shaft_present));
}

TEST_CASE("Arm lowered over the pallet while the clamp is open is a violation (IO-5)") {
  Rig rig;
  rig.move_arm(1, arm::over_pallet);
  rig.set(1, co::arm_down, true);
  CHECK(rig.count(ViolationKind::arm_down_clamp_open) == 1);
}

TEST_CASE("Press lowered while the clamp is open is a violation (IO-5)") {
  Rig rig;
  rig.set(3, co::press_down, true);
  CHECK(rig.count(ViolationKind::press_down_clamp_open) == 1);
}

TEST_CASE("Press lowered while the arm is over the pallet is a violation (IO-5)") {
  Rig rig;
  rig.set(3, co::clamp_close, true);
  rig.move_arm(3, arm::over_pallet);
  rig.set(3, co::press_down, true);
  CHECK(rig.count(ViolationKind::press_down_arm_in_way) == 1);
  CHECK(rig.count(ViolationKind::press_down_clamp_open) == 0);
}

TEST_CASE("Arm moved over the pallet while the press is down is a violation (IO-5)") {
  Rig rig;
  rig.set(3, co::clamp_close, true);
  rig.set(3, co::press_down, true);
  CHECK(rig.verdict().violations == 0);
  rig.move_arm(3, arm::over_pallet);
  CHECK(rig.count(ViolationKind::press_down_arm_in_way) == 1);
}

TEST_CASE("Belt and open stopper against a closed clamp are a violation and the pallet stays (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  rig.set(1, co::stopper_open, true, 1000);
  CHECK(rig.count(ViolationKind::clamp_holds_moving_pallet) == 1);
  CHECK(rig.input(1, di::pallet_in_position));
}

TEST_CASE("Belt and open stopper against a lowered arm are a violation (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  REQUIRE(rig.play(Steps().move(arm::over_pallet).on(co::arm_down, di::arm_is_down).of(1)));
  rig.set(1, co::stopper_open, true, 1000);
  CHECK(rig.count(ViolationKind::arm_holds_moving_pallet) == 1);
}

TEST_CASE("Belt and open stopper against a lowered press are a violation (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(3));
  rig.set(3, co::press_down, true, 300);
  rig.set(3, co::stopper_open, true, 1000);
  CHECK(rig.count(ViolationKind::press_holds_moving_pallet) == 1);
}

TEST_CASE("Arm lowered at a feeder lets the pallet leave without a violation (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  rig.set(1, co::clamp_close, false);
  rig.move_arm(1, 3);
  rig.set(1, co::arm_down, true);
  rig.set(1, co::stopper_open, true, 1000);
  CHECK_FALSE(rig.input(1, di::pallet_in_position));
  CHECK(rig.verdict().violations == 0);
}

TEST_CASE("Pallet let into a transfer zone that is taken is a violation (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  rig.set(1, co::entry_stopper_open, true, 3000);
  CHECK(rig.count(ViolationKind::two_pallets_in_zone) == 1);
  CHECK(rig.plant.pallet_in(1, Zone::entry) == 3);
}

TEST_CASE("Pallet driven into a next entry zone that is taken is a violation (IO-5)") {
  Rig rig;
  REQUIRE(rig.play(whole_sequence(1)));
  REQUIRE(rig.play(Steps().take_in().off(co::clamp_close, di::clamp_is_open).of(1)));
  rig.set(1, co::stopper_open, true, 1000);
  CHECK(rig.count(ViolationKind::two_pallets_in_zone) == 1);
  CHECK(rig.input(1, di::pallet_in_position));
}

// --- faults ---

TEST_CASE("Sensor stuck reads its value for the fault's time and the truth after it (IO-5)") {
  Rig rig;
  Fault stuck = fault(FaultKind::sensor_stuck, 2, di::pallet_in_position, 1);
  stuck.from_ns = 100 * kMs;
  stuck.duration_ns = 200 * kMs;
  rig.plant.inject(stuck);
  rig.run_ms(99);
  CHECK_FALSE(rig.input(2, di::pallet_in_position));
  rig.run_ms(2);
  CHECK(rig.input(2, di::pallet_in_position));
  rig.run_ms(200);
  CHECK_FALSE(rig.input(2, di::pallet_in_position));
}

TEST_CASE("Sensor stuck at 0 hides what is there until it is cleared (IO-5)") {
  Rig rig;
  const int id = rig.plant.inject(fault(FaultKind::sensor_stuck, 1, di::arm_is_up, 0));
  rig.run_ms(1);
  CHECK_FALSE(rig.input(1, di::arm_is_up));
  rig.plant.clear(id);
  rig.run_ms(1);
  CHECK(rig.input(1, di::arm_is_up));
}

TEST_CASE("Register stuck reads its value (IO-5)") {
  Rig rig;
  rig.plant.inject(fault(FaultKind::register_stuck, 1, 3, 7));
  rig.run_ms(1);
  CHECK(rig.io(1).input_registers[3] == 7);
  rig.plant.clear_faults();
  rig.run_ms(1);
  CHECK(rig.io(1).input_registers[3] == 50);
}

TEST_CASE("Actuators jammed stay where they are whatever their coils say (IO-5)") {
  Rig rig;
  for (std::uint32_t coil = 0; coil < kCoils; ++coil) {
    rig.plant.inject(fault(FaultKind::actuator_jammed, 3, coil));
  }
  rig.io(3).coils.fill(true);
  rig.io(3).holding_registers[hr::arm_target] = 3;
  rig.run_ms(2000);
  CHECK(rig.input(3, di::entry_stopper_is_closed));
  CHECK(rig.input(3, di::stopper_is_closed));
  CHECK(rig.input(3, di::clamp_is_open));
  CHECK(rig.input(3, di::arm_is_up));
  CHECK(rig.input(3, di::gripper_is_open));
  CHECK(rig.input(3, di::press_is_up));
  CHECK(rig.io(3).input_registers[ir::arm_position] == arm::home);
}

TEST_CASE("Conveyor jammed carries no pallet (IO-5)") {
  Rig rig;
  rig.plant.inject(fault(FaultKind::actuator_jammed, 1, co::conveyor));
  rig.set(1, co::conveyor, true, 3000);
  CHECK_FALSE(rig.input(1, di::pallet_at_entry));
}

TEST_CASE("Arm jammed between positions stays there until the operator frees it (IO-5)") {
  Rig rig;
  rig.plant.inject(fault(FaultKind::arm_jammed_between, 2));
  rig.move_arm(2, 4);
  CHECK(rig.io(2).input_registers[ir::arm_position] == 0);
  rig.io(2).coils[co::arm_enable] = false;
  CHECK(rig.plant.operator_frees_arm(2));
  CHECK(rig.io(2).input_registers[ir::arm_position] == arm::home);
  rig.move_arm(2, 4);
  CHECK(rig.io(2).input_registers[ir::arm_position] == 4);
}

TEST_CASE("Magazine empty gives no part, is not refilled meanwhile, and is afterwards (IO-5)") {
  Rig rig;
  Fault empty = fault(FaultKind::magazine_empty, 1, 0);
  empty.duration_ns = 20'000 * kMs;
  rig.plant.inject(empty);
  REQUIRE(rig.fetch_from(1, 3));
  CHECK_FALSE(rig.input(1, di::part_in_gripper));
  rig.run_ms(15'000);
  CHECK(rig.io(1).input_registers[3] == 0);
  CHECK(rig.io(1).input_registers[4] == 50);
  rig.run_ms(10'000);
  CHECK(rig.io(1).input_registers[3] == 50);
}

TEST_CASE("Shelf full has its place occupied and takes no piece (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(4));
  rig.plant.inject(fault(FaultKind::magazine_empty, 4, 0));
  REQUIRE(rig.play(Steps().move(2).grip().move(3).of(4)));
  CHECK(rig.input(4, di::place_occupied));
  REQUIRE(rig.play(Steps().release().of(4)));
  CHECK(rig.count(ViolationKind::gripper_opened_astray) == 1);
}

TEST_CASE("Code unreadable leaves the reader without a code until it is cleared (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  const int id = rig.plant.inject(fault(FaultKind::code_unreadable, 1));
  rig.run_ms(500);
  CHECK_FALSE(rig.input(1, di::code_valid));
  rig.plant.clear(id);
  rig.run_ms(60);
  CHECK(rig.io(1).pallet_code() == 101);
}

TEST_CASE("Code wrong makes the reader report another code while the ledger knows the true one (IO-5)") {
  Rig rig;
  rig.plant.inject(fault(FaultKind::code_wrong, 1, 0, 999));
  REQUIRE(rig.bring_to(1));
  CHECK(rig.io(1).pallet_code() == 999);
  CHECK(rig.plant.ledger().pallets()[0].code == 101);
}

TEST_CASE("Pallet lost from a zone is taken out once and counts as removed (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  rig.plant.inject(fault(FaultKind::pallet_lost, 1, static_cast<std::uint32_t>(Zone::position)));
  rig.run_ms(10);
  CHECK_FALSE(rig.input(1, di::pallet_in_position));
  CHECK(rig.verdict().removed == 1);
  rig.set(1, co::clamp_close, false);
  REQUIRE(rig.play(Steps().take_in().of(1)));
  rig.run_ms(1000);
  CHECK(rig.input(1, di::pallet_in_position));
  CHECK(rig.verdict().removed == 1);
}

TEST_CASE("Part lost waits for its first opportunity and falls from the gripper (IO-5)") {
  Rig rig;
  rig.plant.inject(fault(FaultKind::part_lost, 1));
  rig.run_ms(1000);
  REQUIRE(rig.fetch_from(1, 3));
  CHECK(rig.input(1, di::gripper_is_closed));
  CHECK_FALSE(rig.input(1, di::part_in_gripper));
  CHECK(rig.verdict().parts_removed == 1);
  CHECK(rig.verdict().violations == 0);
}

TEST_CASE("Part that falls off the pallet takes what is on it along (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(2));
  REQUIRE(rig.play(Steps().fetch(Part::bearing, 3).fetch(Part::shaft, 5).of(2)));
  rig.plant.inject(fault(FaultKind::part_off_pallet, 2, static_cast<std::uint32_t>(Part::bearing)));
  rig.run_ms(2);
  CHECK_FALSE(rig.input(2, di::bearing_present));
  CHECK_FALSE(rig.input(2, di::shaft_present));
  CHECK(rig.plant.station(2).position.pallet.loaded());
  CHECK(rig.verdict().parts_removed == 2);
}

TEST_CASE("Infeed stopped gives no pallet until it goes on (IO-5)") {
  Rig rig;
  Fault stops = fault(FaultKind::infeed_stops, 1);
  stops.duration_ns = 2'000 * kMs;
  rig.plant.inject(stops);
  rig.run_ms(2000);
  CHECK(rig.plant.pallets_entered() == 0);
  rig.run_ms(400);
  CHECK(rig.plant.pallets_entered() == 1);
}

TEST_CASE("Fault on a unit, index or value that is not there is refused (IO-5)") {
  Plant plant;
  CHECK_THROWS_AS(plant.inject(fault(FaultKind::sensor_stuck, 5)), std::invalid_argument);
  CHECK_THROWS_AS(plant.inject(fault(FaultKind::sensor_stuck, 1, 20)), std::invalid_argument);
  CHECK_THROWS_AS(plant.inject(fault(FaultKind::sensor_stuck, 1, 0, 2)), std::invalid_argument);
  CHECK_THROWS_AS(plant.inject(fault(FaultKind::actuator_jammed, 1, 9)), std::invalid_argument);
  CHECK_THROWS_AS(plant.inject(fault(FaultKind::magazine_empty, 1, 2)), std::invalid_argument);
  CHECK_THROWS_AS(plant.inject(fault(FaultKind::infeed_stops, 2)), std::invalid_argument);
}

// --- the operator's hands ---

TEST_CASE("Operator takes a part out of the gripper without a violation (IO-5)") {
  Rig rig;
  REQUIRE(rig.fetch_from(1, 3));
  CHECK(rig.plant.operator_removes_from_gripper(1));
  CHECK_FALSE(rig.input(1, di::part_in_gripper));
  CHECK_FALSE(rig.plant.operator_removes_from_gripper(1));
  rig.set(1, co::gripper_close, false);
  CHECK(rig.verdict().clean());
  CHECK(rig.verdict().parts_removed == 1);
}

TEST_CASE("Operator takes a piece out of storage's gripper and it counts as removed (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(4));
  REQUIRE(rig.play(Steps().move(2).grip().of(4)));
  CHECK(rig.plant.operator_removes_from_gripper(4));
  REQUIRE(rig.play(Steps().give_away().of(4)));
  rig.run_ms(1000);
  CHECK(rig.verdict().removed == 1);
  CHECK(rig.verdict().left_unstored == 0);
  CHECK(rig.verdict().clean());
}

TEST_CASE("Operator takes a pallet out of any zone and it counts as removed (IO-5)") {
  Rig rig;
  rig.run_ms(1000);
  CHECK(rig.plant.operator_removes_pallet(1, Zone::entry));
  CHECK_FALSE(rig.plant.operator_removes_pallet(1, Zone::transfer));
  CHECK_FALSE(rig.plant.operator_removes_pallet(4, Zone::outfeed));
  CHECK(rig.verdict().removed == 1);
  CHECK(rig.verdict().in_cell == 0);
}

TEST_CASE("Operator takes a part off the pallet in position (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(2));
  CHECK_FALSE(rig.plant.operator_removes_part(2, Part::bearing));
  CHECK(rig.plant.operator_removes_part(2, Part::base));
  CHECK_FALSE(rig.plant.station(2).position.pallet.loaded());
}

TEST_CASE("Operator fills the magazines at once (IO-5)") {
  Rig rig;
  rig.plant.operator_sets_level(2, 3, 0);
  CHECK(rig.io(2).input_registers[6] == 0);
  rig.plant.operator_refills(2);
  CHECK(rig.io(2).input_registers[6] == 50);
}

// --- the command line's faults ---

TEST_CASE("Fault written out in full is read with names, value and times (IO-5)") {
  const Fault read = parse_fault("sensor:2.pallet_in_position=1@5s+2500ms");
  CHECK(read.kind == FaultKind::sensor_stuck);
  CHECK(read.unit == 2);
  CHECK(read.index == di::pallet_in_position);
  CHECK(read.value == 1);
  CHECK(read.from_ns == 5'000 * kMs);
  CHECK(read.duration_ns == 2'500 * kMs);
  CHECK(parse_fault("jam:3.press_down").index == co::press_down);
  CHECK(parse_fault("magazine_empty:2.shaft_2").index == 3);
  CHECK(parse_fault("pallet_lost:1.transfer@1s").index == 1);
  CHECK(parse_fault("code_wrong:4=4294967295").value == 4294967295U);
  CHECK(parse_fault("infeed_stops:1").duration_ns == 0);
}

TEST_CASE("Fault that is not well written is refused with what is allowed (IO-5)") {
  for (const char* text :
       {"", "sensor", "sensor:", "sensor:9.0=1", "sensor:1=1", "sensor:1.0", "sensor:1.lid_seated=1",
        "jam:1.conveyor=1", "nothing:1", "part_lost:1@5", "part_lost:1+x", "code_wrong:1",
        "sensor:1.0=99999999999", "infeed_stops:1.entry"}) {
    INFO(text);
    CHECK_THROWS_AS(parse_fault(text), std::invalid_argument);
  }
}

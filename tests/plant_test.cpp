// The plant's physics, its repeatability and its saved state.
#include <doctest/doctest.h>

#include <chrono>
#include <stdexcept>
#include <string>

#include "io/plant/plant.hpp"
#include "tests/plant_autopilot.hpp"

using namespace stationd::plant;
using namespace stationd::plant::test;

namespace {
constexpr std::int64_t kS = 1'000'000'000;

std::string ledger_after(std::uint64_t seed, std::int64_t run_ns) {
  PlantConfig config;
  config.seed = seed;
  Plant plant(config);
  Autopilot().run(plant, run_ns);
  return plant.ledger().to_json(plant.now_ns(), true);
}
}  // namespace

TEST_CASE("Plant driven through twenty pallets stores each piece once and right (IO-5)") {
  PlantConfig config;
  config.pallets = 20;
  Plant plant(config);
  Autopilot().run(plant, 150 * kS);
  const Verdict verdict = plant.ledger().verdict();
  CHECK(verdict.pallets == 20);
  CHECK(verdict.stored_right == 20);
  CHECK(verdict.in_cell == 0);
  CHECK(verdict.clean());
}

TEST_CASE("Plant run twice from one seed gives the same ledger (IO-5)") {
  CHECK(ledger_after(7, 60 * kS) == ledger_after(7, 60 * kS));
}

TEST_CASE("Plant run from two seeds gives two ledgers (IO-5)") {
  CHECK(ledger_after(7, 60 * kS) != ledger_after(8, 60 * kS));
}

TEST_CASE("Plant stepped coarsely stores a thousand pieces right, in seconds (IO-5)") {
  PlantConfig config;
  config.step_ns = 10'000'000;
  Plant plant(config);
  const auto start = std::chrono::steady_clock::now();
  Autopilot().run(plant, 4'800 * kS);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  MESSAGE(took.count() << " s for 480,000 steps, stored " << plant.ledger().verdict().stored);
  CHECK(plant.ledger().verdict().stored_right >= 1000);
  CHECK(plant.ledger().verdict().clean());
  CHECK(took.count() < 20.0);
}

TEST_CASE("Plant at rest shows every actuator at its de-energised end (IO-5)") {
  Rig rig;
  CHECK(rig.input(3, di::entry_stopper_is_closed));
  CHECK(rig.input(3, di::stopper_is_closed));
  CHECK(rig.input(3, di::clamp_is_open));
  CHECK(rig.input(3, di::arm_is_up));
  CHECK(rig.input(3, di::gripper_is_open));
  CHECK(rig.input(3, di::press_is_up));
  CHECK(rig.input(3, di::next_entry_clear));
  CHECK(rig.io(3).input_registers[ir::arm_position] == arm::home);
  CHECK(rig.io(3).input_registers[ir::level_first] == 50);
}

TEST_CASE("End switch of an actuator on its way shows neither end (IO-5)") {
  Rig rig;
  rig.set(1, co::clamp_close, true, 40);
  CHECK_FALSE(rig.input(1, di::clamp_is_open));
  CHECK_FALSE(rig.input(1, di::clamp_is_closed));
  rig.run_ms(40);
  CHECK(rig.input(1, di::clamp_is_closed));
}

TEST_CASE("Pallet with the belt standing stays where it is (IO-5)") {
  Rig rig;
  rig.run_ms(3000);
  CHECK(rig.plant.pallet_in(1, Zone::entry) == 1);
  CHECK_FALSE(rig.input(1, di::pallet_at_entry));
}

TEST_CASE("Pallet at a closed entry stopper waits there, and the infeed waits behind it (IO-5)") {
  Rig rig;
  rig.set(1, co::conveyor, true, 3000);
  CHECK(rig.input(1, di::pallet_at_entry));
  CHECK_FALSE(rig.input(1, di::pallet_in_transfer));
  CHECK(rig.plant.pallets_entered() == 1);
}

TEST_CASE("Pallet that passes an open entry stopper reaches the position by the transfer zone (IO-5)") {
  Rig rig;
  rig.io(1).coils[co::conveyor] = true;
  rig.set(1, co::entry_stopper_open, true, 700);
  rig.set(1, co::entry_stopper_open, false, 100);
  CHECK(rig.input(1, di::pallet_in_transfer));
  CHECK_FALSE(rig.input(1, di::pallet_in_position));
  rig.run_ms(400);
  CHECK_FALSE(rig.input(1, di::pallet_in_transfer));
  CHECK(rig.input(1, di::pallet_in_position));
}

TEST_CASE("Pallet behind one in position waits in the transfer zone (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  rig.set(1, co::entry_stopper_open, true, 500);
  rig.set(1, co::entry_stopper_open, false, 2000);
  CHECK(rig.plant.pallet_in(1, Zone::position) == 1);
  CHECK(rig.plant.pallet_in(1, Zone::transfer) == 2);
  CHECK(rig.verdict().violations == 0);
}

TEST_CASE("Pallet that leaves the position stands in the next entry zone at once (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  rig.set(1, co::clamp_close, false);
  CHECK(rig.input(1, di::next_entry_clear));
  rig.set(1, co::stopper_open, true, 229);
  CHECK(rig.input(1, di::pallet_in_position));
  CHECK(rig.input(1, di::next_entry_clear));
  rig.run_ms(2);
  CHECK_FALSE(rig.input(1, di::pallet_in_position));
  CHECK_FALSE(rig.input(1, di::next_entry_clear));
  CHECK(rig.plant.pallet_in(2, Zone::entry) == 1);
  CHECK_FALSE(rig.input(2, di::pallet_at_entry));
}

TEST_CASE("Code reader over a pallet shows the code while it is on (IO-5)") {
  Rig rig(Rig::one_type(70'000));
  REQUIRE(rig.bring_to(1));
  CHECK(rig.io(1).pallet_code() == 70'000);
  CHECK(rig.io(1).input_registers[ir::pallet_code_high] == 1);
  rig.set(1, co::read_code, false, 1);
  CHECK_FALSE(rig.input(1, di::code_valid));
  CHECK(rig.io(1).pallet_code() == 0);
}

TEST_CASE("Arm between positions shows position 0, and stands when not enabled (IO-5)") {
  Rig rig;
  rig.io(2).holding_registers[hr::arm_target] = 3;
  rig.set(2, co::arm_enable, true, 150);
  CHECK(rig.io(2).input_registers[ir::arm_position] == 0);
  rig.run_ms(50);
  rig.set(2, co::arm_enable, false, 1000);
  CHECK(rig.io(2).input_registers[ir::arm_position] == 0);
  rig.set(2, co::arm_enable, true, 100);
  CHECK(rig.io(2).input_registers[ir::arm_position] == 3);
}

TEST_CASE("Arm with a target that is not there does not move (IO-5)") {
  Rig rig;
  rig.move_arm(1, 5);
  CHECK(rig.io(1).input_registers[ir::arm_position] == arm::home);
  rig.move_arm(1, 0);
  CHECK(rig.io(1).input_registers[ir::arm_position] == arm::home);
}

TEST_CASE("Gripper closed at a lowered feeder takes one part (IO-5)") {
  Rig rig;
  REQUIRE(rig.fetch_from(2, 6));
  CHECK(rig.input(2, di::part_in_gripper));
  CHECK(rig.io(2).input_registers[6] == 49);
  CHECK(rig.plant.station(2).held.part == Part::shaft);
  CHECK(rig.plant.station(2).held.variant == 2);
}

TEST_CASE("Gripper closed above a feeder takes nothing (IO-5)") {
  Rig rig;
  rig.move_arm(1, 3);
  rig.set(1, co::gripper_close, true);
  CHECK(rig.input(1, di::gripper_is_closed));
  CHECK_FALSE(rig.input(1, di::part_in_gripper));
  CHECK(rig.io(1).input_registers[3] == 50);
}

TEST_CASE("Part placed on the pallet is seen there and entered in the ledger (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  REQUIRE(rig.fetch_from(1, 4));
  CHECK_FALSE(rig.input(1, di::base_present));
  REQUIRE(rig.play(Steps().release().of(1)));
  CHECK(rig.input(1, di::base_present));
  CHECK_FALSE(rig.input(1, di::part_in_gripper));
  CHECK(rig.plant.ledger().pallets()[0].variant[0] == 2);
  CHECK(rig.plant.ledger().pallets()[0].placed_ns[0] > 0);
}

TEST_CASE("Lid pressed for the type's time is seated, and not before (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(3));
  REQUIRE(rig.play(Steps().fetch(Part::lid, 3).move(arm::home).of(3)));
  rig.set(3, co::press_down, true, 480);
  CHECK(rig.input(3, di::press_is_down));
  CHECK_FALSE(rig.input(3, di::lid_seated));
  rig.set(3, co::press_down, false, 300);
  rig.set(3, co::press_down, true, 480);
  CHECK_FALSE(rig.input(3, di::lid_seated));
  rig.run_ms(30);
  CHECK(rig.input(3, di::lid_seated));
}

TEST_CASE("Piece put on a shelf stays in sight until the arm leaves (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(4));
  CHECK(rig.input(4, di::piece_present));
  REQUIRE(rig.play(Steps().move(2).grip().move(3).of(4)));
  CHECK_FALSE(rig.input(4, di::piece_present));
  CHECK_FALSE(rig.input(4, di::place_occupied));
  REQUIRE(rig.play(Steps().release().of(4)));
  CHECK(rig.input(4, di::place_occupied));
  CHECK(rig.io(4).input_registers[3] == 49);
  rig.move_arm(4, arm::home);
  rig.move_arm(4, 3);
  CHECK_FALSE(rig.input(4, di::place_occupied));
  CHECK(rig.verdict().stored_right == 1);
}

TEST_CASE("Piece taken back from its shelf and stored again counts as stored twice (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(4));
  REQUIRE(rig.play(Steps().move(2).grip().move(3).release().grip().of(4)));
  CHECK(rig.verdict().stored == 0);
  REQUIRE(rig.play(Steps().release().of(4)));
  CHECK(rig.verdict().stored == 1);
  CHECK(rig.verdict().stored_twice == 1);
  CHECK(rig.verdict().stored_wrong == 1);
  CHECK_FALSE(rig.verdict().clean());
}

TEST_CASE("Empty pallet behind storage is taken by the outfeed after a moment (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(4));
  Steps steps;
  REQUIRE(rig.play(work(steps, 4).give_away().of(4)));
  CHECK_FALSE(rig.input(4, di::next_entry_clear));
  rig.run_ms(400);
  CHECK(rig.input(4, di::next_entry_clear));
  CHECK(rig.plant.ledger().pallets()[0].left_ns > 0);
  CHECK(rig.plant.ledger().fate_of(rig.plant.ledger().pallets()[0]) == Fate::right);
}

TEST_CASE("Pallet that leaves the cell with its piece counts as unstored (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(4));
  REQUIRE(rig.play(Steps().give_away().of(4)));
  rig.run_ms(400);
  CHECK(rig.verdict().left_unstored == 1);
  CHECK_FALSE(rig.verdict().clean());
}

TEST_CASE("Stored piece with a wrong and a missing part is judged by the plant's own table (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  REQUIRE(rig.fetch_from(1, 4));  // type 101 takes base 1
  REQUIRE(rig.play(Steps().release().move(arm::home).give_away().of(1)));
  REQUIRE(rig.play(Steps().take_in().give_away().of(2)));
  REQUIRE(rig.play(Steps().take_in().give_away().of(3)));
  REQUIRE(rig.play(Steps().take_in().move(2).grip().move(4).release().of(4)));
  const Verdict verdict = rig.verdict();
  CHECK(verdict.stored_wrong == 1);
  CHECK(verdict.wrong_parts == 1);
  CHECK(verdict.missing_parts == 3);
  CHECK(verdict.unseated == 1);
  CHECK(verdict.wrong_shelf == 1);
}

TEST_CASE("Magazine that stays low is refilled by the operator, without one it runs empty (IO-5)") {
  Rig attended, alone = Rig([] {
                  PlantConfig config;
                  config.automatic_operator = false;
                  return config;
                }());
  attended.plant.operator_sets_level(1, 0, 3);
  alone.plant.operator_sets_level(1, 0, 3);
  attended.run_ms(4900);
  CHECK(attended.io(1).input_registers[3] == 3);
  attended.run_ms(200);
  alone.run_ms(10'000);
  CHECK(attended.io(1).input_registers[3] == 50);
  CHECK(alone.io(1).input_registers[3] == 3);
}

TEST_CASE("Unit not written to for its watchdog's time drops all coils but the gripper's (IO-6)") {
  PlantConfig config = Rig::one_type(101);
  config.watchdog_ns = 500'000'000;
  Rig rig(config);
  rig.io(1).coils.fill(true);
  rig.io(1).holding_registers[hr::arm_target] = 1;
  rig.plant.note_write(1);
  rig.run_ms(490);
  CHECK(rig.io(1).coils[co::conveyor]);
  rig.plant.note_write(1);
  rig.run_ms(490);
  CHECK(rig.io(1).coils[co::conveyor]);
  rig.run_ms(20);
  CHECK_FALSE(rig.io(1).coils[co::conveyor]);
  CHECK_FALSE(rig.io(1).coils[co::clamp_close]);
  CHECK(rig.io(1).coils[co::gripper_close]);
  CHECK(rig.io(1).holding_registers[hr::arm_target] == 1);
}

TEST_CASE("Unit that drops its coils in the middle of a placement violates nothing (IO-6)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  REQUIRE(rig.fetch_from(1, 3));
  rig.set(1, co::arm_down, true, 300);
  rig.plant.de_energise(1);
  rig.run_ms(1000);
  CHECK(rig.verdict().violations == 0);
  CHECK(rig.input(1, di::part_in_gripper));
  CHECK(rig.input(1, di::clamp_is_open));
  CHECK(rig.input(1, di::arm_is_up));
}

TEST_CASE("Unit that drops its coils while the gripper opens still places the part (IO-6)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  REQUIRE(rig.fetch_from(1, 3));
  rig.set(1, co::arm_down, true, 300);
  rig.set(1, co::gripper_close, false, 1);
  rig.plant.de_energise(1);
  rig.run_ms(1000);
  CHECK(rig.verdict().violations == 0);
  CHECK(rig.input(1, di::base_present));
}

TEST_CASE("Part let go when the arm is on its way up is dropped (IO-5)") {
  Rig rig;
  REQUIRE(rig.bring_to(1));
  REQUIRE(rig.fetch_from(1, 3));
  rig.set(1, co::arm_down, true, 300);
  rig.set(1, co::arm_down, false, 50);
  rig.set(1, co::gripper_close, false);
  CHECK(rig.count(ViolationKind::gripper_opened_astray) == 1);
  CHECK_FALSE(rig.input(1, di::base_present));
}

TEST_CASE("Saved plant loaded into a new one goes on as the first does (IO-5)") {
  Plant first;
  Autopilot().run(first, 33 * kS);
  Plant second;
  second.load(first.save());
  for (int unit = 1; unit <= kUnits; ++unit) first.de_energise(unit);
  for (int unit = 1; unit <= kUnits; ++unit)
    first.unit(unit).holding_registers = second.unit(unit).holding_registers;
  first.advance_to(40 * kS);
  second.advance_to(40 * kS);
  CHECK(first.save() == second.save());
  CHECK(first.ledger().to_json(0, true) == second.ledger().to_json(0, true));
}

TEST_CASE("Saved plant loaded comes up with coils dropped and the part still in its gripper (IO-6)") {
  Rig rig;
  REQUIRE(rig.fetch_from(1, 3));
  Plant loaded;
  loaded.load(rig.plant.save());
  loaded.advance_to(loaded.now_ns() + kS);
  CHECK(loaded.unit(1).coils[co::gripper_close]);
  CHECK_FALSE(loaded.unit(1).coils[co::arm_enable]);
  CHECK(loaded.unit(1).discrete_inputs[di::part_in_gripper]);
  CHECK(loaded.ledger().verdict().violations == 0);
}

TEST_CASE("State cut short, altered or of another kind is refused and changes nothing (IO-5)") {
  Rig rig;
  rig.run_ms(5000);
  const std::string good = rig.plant.save();
  std::string altered = good;
  altered[good.size() / 2] = altered[good.size() / 2] == '7' ? '8' : '7';
  Plant plant;
  CHECK_THROWS_AS(plant.load(good.substr(0, good.size() / 2)), std::runtime_error);
  CHECK_THROWS_AS(plant.load(good.substr(0, good.size() - 2)), std::runtime_error);
  CHECK_THROWS_AS(plant.load(altered), std::runtime_error);
  CHECK_THROWS_AS(plant.load("hello"), std::runtime_error);
  CHECK_THROWS_AS(plant.load(""), std::runtime_error);
  CHECK(plant.now_ns() == 0);
}

TEST_CASE("Plant with an impossible configuration is refused (IO-5)") {
  PlantConfig no_types, no_step, no_time;
  no_types.types.clear();
  no_step.step_ns = 1;
  no_time.times.clamp_ns = 0;
  CHECK_THROWS_AS(Plant{no_types}, std::invalid_argument);
  CHECK_THROWS_AS(Plant{no_step}, std::invalid_argument);
  CHECK_THROWS_AS(Plant{no_time}, std::invalid_argument);
}

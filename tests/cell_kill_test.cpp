// A station dies by kill -9 in every step of its program, at random moments, alone and with its controller.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>

#include "scan/codes.hpp"
#include "tests/cell_harness.hpp"

using namespace stationd;
using namespace stationd::test;

namespace {

constexpr std::int64_t kRun_ns = 600 * kSecond;
constexpr std::uint64_t kSlowDisk = 90;  // 900 ms: longer than a pallet takes from the entry into position
constexpr std::int64_t kDead_ns = 1 * kSecond;

struct Death {
  int unit = kLoader;
  std::uint32_t step = 0;
  int occurrence = 3;  ///< the how-manieth time that the step is entered
  int scans_later = 0;
  AfterDeath after = AfterDeath::drop_at_once;
  bool last_write_made_it = false;
};

CellOptions few_pallets(std::uint64_t seed) {
  CellOptions options;
  options.seed = seed;
  options.pallets = 7;
  options.codes = {101, 102, 103, 102, 102, 101, 103};
  return options;
}

/// Runs until the station has entered the step that often; false if it does not happen.
bool run_into(CellHarness& cell, const Death& death) {
  int entered = 0;
  bool inside = false;
  const auto is_in = [&] {
    return death.step >= 50 ? cell.arm_step(death.unit) == death.step
                            : cell.track_step(death.unit) == death.step;
  };
  const bool found = cell.run_until(
      [&] {
        const bool now_inside = is_in();
        entered += now_inside && !inside ? 1 : 0;
        inside = now_inside;
        return entered >= death.occurrence;
      },
      kRun_ns);
  for (int i = 0; i < death.scans_later && found; ++i) cell.scan();
  return found;
}

void kill_and_revive(CellHarness& cell, std::initializer_list<int> units, AfterDeath after,
                     bool last_write_made_it) {
  for (const int unit : units) cell.kill(unit, after, last_write_made_it);
  cell.run_until([] { return false; }, kDead_ns);
  for (const int unit : units) cell.revive(unit);
}

/// Steps that are passed once, at the beginning, or not in a run without trouble.
int occurrence_of(std::uint32_t step) { return step == 1 || step == 8 || step == 50 || step == 51 ? 1 : 3; }

int kill_in_every_step(int unit) {
  int runs = 0;
  std::set<std::uint32_t> died_in;
  const std::set<std::uint32_t> steps =
      CellHarness::all_steps(kStationNames[static_cast<std::size_t>(unit - 1)]);
  for (const std::uint32_t step : steps) {
    for (int variant = 0; variant < 16; variant += kThin) {
      Death death;
      death.unit = unit;
      death.step = step;
      death.occurrence = occurrence_of(step);
      death.scans_later = variant % 8 < 4 ? 0 : 3;
      death.after = variant % 2 == 0 ? AfterDeath::drop_at_once : AfterDeath::stay_a_while;
      death.last_write_made_it = variant % 4 >= 2;
      CellOptions options = few_pallets(step);
      if (variant >= 8) options.commit_after_scans = kSlowDisk;
      CellHarness cell(options);
      if (step == 8 && unit > kLoader)  // waits for an End only when it was not heard before the pallet came
        cell.withhold("End/" + std::string(kStationNames[static_cast<std::size_t>(unit - 2)]));
      if (step == 51) {  // entered only by a restart with an empty gripper closed
        Death before = death;
        before.step = 58;
        before.occurrence = 2;
        before.scans_later = 2;
        before.after = AfterDeath::drop_at_once;
        REQUIRE(run_into(cell, before));
        kill_and_revive(cell, {unit}, before.after, false);
      }
      if (step == 68) {  // entered only when the gripper does not open
        Death before = death;
        before.step = 65;
        before.scans_later = 0;
        REQUIRE(run_into(cell, before));
        plant::Fault jam;
        jam.kind = plant::FaultKind::actuator_jammed;
        jam.unit = unit;
        jam.index = plant::co::gripper_close;
        cell.plant().inject(jam);
        death.occurrence = 1;
      }
      if (!run_into(cell, death)) continue;
      died_in.insert(step);
      kill_and_revive(cell, {unit}, death.after, death.last_write_made_it);
      cell.withhold("");
      cell.plant().clear_faults();
      cell.run_out(kRun_ns);
      ++runs;
      INFO("unit ", unit, ", step ", step, ", variant ", variant);
      CHECK(cell.complaint() == "");
      CHECK(cell.faults_raised() == 0);
    }
  }
  for (const std::uint32_t step : steps) {
    INFO("unit ", unit, ", step ", step);
    CHECK(died_in.count(step) == 1);
  }
  return runs;
}

}  // namespace

TEST_CASE("Loader killed at any step goes on from the sensors (IMG-5)") {
  CHECK(kill_in_every_step(kLoader) > 200 / kThin);
}
TEST_CASE("Robot killed at any step goes on from the sensors (IMG-5)") {
  CHECK(kill_in_every_step(kRobot) > 200 / kThin);
}
TEST_CASE("Sealer killed at any step goes on from the sensors (IMG-5)") {
  CHECK(kill_in_every_step(kSealer) > 200 / kThin);
}
TEST_CASE("Storage killed at any step goes on from the sensors (IMG-5)") {
  CHECK(kill_in_every_step(kStorage) > 200 / kThin);
}

TEST_CASE("Stations killed at random moments, again and again, miss and double no part (IMG-5)") {
  std::mt19937_64 random(7);
  int faults = 0;
  for (std::uint64_t seed = 1; seed <= 60; seed += kThin) {
    CellOptions options = few_pallets(seed);
    options.commit_after_scans = seed % 5;
    CellHarness cell(options);
    for (int deaths = 0; deaths < 6; ++deaths) {
      const auto wait_ns = static_cast<std::int64_t>(random() % 600) * 10 * kMs;
      cell.run_until([] { return false; }, wait_ns + kSecond);
      kill_and_revive(cell, {static_cast<int>(random() % 4) + 1},
                      random() % 2 == 0 ? AfterDeath::drop_at_once : AfterDeath::stay_a_while,
                      random() % 2 == 0);
    }
    cell.run_out(kRun_ns);
    INFO("seed ", seed);
    CHECK(cell.complaint() == "");
    faults += cell.faults_raised();
  }
  std::printf("360 random kills: %d questions to the operator\n", faults);
}

TEST_CASE("Pairs of stations killed at random moments miss and double no part (IMG-5)") {
  std::mt19937_64 random(11);
  int faults = 0;
  for (std::uint64_t seed = 1; seed <= 40; seed += kThin) {
    CellHarness cell(few_pallets(seed));
    for (int deaths = 0; deaths < 4; ++deaths) {
      cell.run_until([] { return false; }, static_cast<std::int64_t>(random() % 600) * 10 * kMs + kSecond);
      const AfterDeath after = random() % 2 == 0 ? AfterDeath::drop_at_once : AfterDeath::stay_a_while;
      constexpr std::array<std::array<int, 2>, 3> kPairs = {
          {{kLoader, kRobot}, {kSealer, kStorage}, {kRobot, kSealer}}};
      const auto& pair = kPairs[random() % kPairs.size()];
      kill_and_revive(cell, {pair[0], pair[1]}, after, random() % 2 == 0);
    }
    cell.run_out(kRun_ns);
    INFO("seed ", seed);
    CHECK(cell.complaint() == "");
    faults += cell.faults_raised();
  }
  std::printf("160 random kills of pairs: %d questions to the operator\n", faults);
}

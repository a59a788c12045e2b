// The four programs against the plant model, without DDS or threads: plain runs, Stop and Start, lossy bus.
#include <doctest/doctest.h>

#include <chrono>
#include <cstdio>
#include <random>

#include "scan/codes.hpp"
#include "tests/cell_harness.hpp"

using namespace stationd;
using namespace stationd::test;

TEST_CASE("Cell assembling 1,000 mixed pieces stores every piece once, right, without a fault (IMG-5)") {
  CellOptions options;
  options.pallets = 1000 / kThin;
  CellHarness cell(options);
  const auto begin = std::chrono::steady_clock::now();
  const bool out = cell.run_out(20'000 * kSecond);
  const auto took =
      std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - begin);
  std::printf("%u pieces: %lld s of plant time in %lld ms\n", options.pallets,
              static_cast<long long>(cell.now_ns() / kSecond), static_cast<long long>(took.count()));
  CHECK(out);
  CHECK(cell.complaint() == "");
  CHECK(cell.faults_raised() == 0);
  CHECK(cell.plant().ledger().verdict().stored_right == options.pallets);
}

TEST_CASE(
    "Stop immediate at random moments, then Start: no piece is harmed (cell.md, Stop in the middle of a "
    "piece)") {
  std::mt19937_64 random(3);
  for (std::uint64_t seed = 1; seed <= 20; seed += kThin) {
    CellOptions options;
    options.seed = seed;
    options.pallets = 8;
    CellHarness cell(options);
    for (int stops = 0; stops < 15; ++stops) {
      cell.run_until([] { return false; }, static_cast<std::int64_t>(random() % 300) * 10 * kMs);
      cell.stop(static_cast<int>(random() % 4) + 1, StopMode::immediate);
      if (random() % 3 == 0) cell.stop(static_cast<int>(random() % 4) + 1, StopMode::immediate);
    }
    cell.run_out(1'000 * kSecond);
    INFO("seed ", seed);
    CHECK(cell.complaint() == "");
    CHECK(cell.faults_raised() == 0);
  }
}

TEST_CASE("Stop end_of_piece lets every station finish its piece, and Start goes on (cell.md)") {
  for (std::uint64_t seed = 1; seed <= 20; seed += kThin) {
    CellOptions options;
    options.seed = seed;
    options.pallets = 10;
    CellHarness cell(options);
    cell.run_until([] { return false; }, 10 * kSecond + static_cast<std::int64_t>(seed) * 730 * kMs);
    cell.keep_running = {false, false, false, false};
    for (int unit = kLoader; unit <= kStorage; ++unit) cell.stop(unit, StopMode::end_of_piece);
    const auto all_stopped = [&] {
      bool all = true;
      for (int unit = kLoader; unit <= kStorage; ++unit)
        all = all && cell.state(unit) == StationState::STOPPED;
      return all;
    };
    INFO("seed ", seed);
    CHECK(cell.run_until(all_stopped, 60 * kSecond));
    for (int unit = kLoader; unit <= kStorage; ++unit) {
      const bool has_pallet = cell.plant().unit(unit).discrete_inputs[plant::di::pallet_in_position];
      const Image& image = cell.station(unit).image();
      const bool ended = *image.value(*image.find("piece.ended")) != 0;
      CHECK(has_pallet == ended);
    }
    cell.keep_running = {true, true, true, true};
    cell.run_out(1'000 * kSecond);
    CHECK(cell.complaint() == "");
    CHECK(cell.faults_raised() == 0);
  }
}

TEST_CASE("Cell with 30 % of PV samples lost assembles every piece once and asks nothing (PV-7)") {
  CellOptions options;
  options.pallets = 100;
  options.samples_lost = 0.3;
  CellHarness cell(options);
  cell.run_out(2'000 * kSecond);
  CHECK(cell.complaint() == "");
  CHECK(cell.faults_raised() == 0);
}

TEST_CASE("Cell on a plant of 1 ms steps and scans assembles every piece once (SCAN-2)") {
  CellOptions options;
  options.pallets = 20;
  options.scan_ns = 1 * kMs;
  options.plant_step_ns = 1 * kMs;
  CellHarness cell(options);
  cell.run_out(500 * kSecond);
  CHECK(cell.complaint() == "");
  CHECK(cell.faults_raised() == 0);
}

TEST_CASE("Station restarted without its retained data asks, and no piece is harmed by the answers (IMG-5)") {
  std::mt19937_64 random(5);
  int questions = 0;
  for (std::uint64_t seed = 1; seed <= 40; seed += kThin) {
    CellOptions options;
    options.seed = seed;
    options.pallets = 8;
    CellHarness cell(options);
    cell.run_until([] { return false; }, 5 * kSecond + static_cast<std::int64_t>(random() % 2000) * 10 * kMs);
    const int unit = static_cast<int>(random() % 3) + 1;
    cell.kill(unit, AfterDeath::stay_a_while, true);
    cell.run_until([] { return false; }, 1 * kSecond);
    cell.revive(unit, true);
    cell.run_out(1'000 * kSecond);
    INFO("seed ", seed, ", unit ", unit);
    CHECK(cell.complaint() == "");
    questions += cell.faults_raised();
  }
  std::printf("40 restarts without retained data: %d questions\n", questions);
}

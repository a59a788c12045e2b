#include <doctest/doctest.h>

#include <chrono>

#include "io/plant/plant.hpp"
#include "tests/plant_autopilot.hpp"

using namespace stationd::plant;
using stationd::plant::test::Autopilot;

namespace {
constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kS = 1'000 * kMs;
}  // namespace

TEST_CASE("Plant driven through twenty pallets stores each piece right (IO-5)") {
  PlantConfig config;
  config.pallets = 20;
  Plant plant(config);
  Autopilot().run(plant, 150 * kS);
  const Verdict verdict = plant.ledger().verdict();
  MESSAGE(plant.ledger().to_json(plant.now_ns(), true));
  CHECK(verdict.stored_right == 20);
  CHECK(verdict.in_cell == 0);
  CHECK(verdict.clean());
}

TEST_CASE("Plant of a thousand pieces runs in seconds (IO-5)") {
  Plant plant;
  Autopilot pilot;
  const auto start = std::chrono::steady_clock::now();
  pilot.run(plant, 4000 * kS);
  const std::chrono::duration<double> t = std::chrono::steady_clock::now() - start;
  MESSAGE(t.count() << " s, stored " << plant.ledger().verdict().stored_right);
  for (int i = 0; i < 4'000'000; ++i) plant.step();
  const std::chrono::duration<double> t2 = std::chrono::steady_clock::now() - start - t;
  MESSAGE(t2.count() << " s for 4M steps alone");
}

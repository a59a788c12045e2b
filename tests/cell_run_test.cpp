// The four programs against the plant model, without DDS or threads: plain runs, Stop and Start, lossy bus.
#include <doctest/doctest.h>

#include <chrono>
#include <cstdio>

#include "scan/codes.hpp"
#include "tests/cell_harness.hpp"

using namespace stationd;
using namespace stationd::test;

TEST_CASE("Cell assembling 1,000 mixed pieces stores every piece once, right, without a fault (SYS-5)") {
  CellOptions options;
  options.pallets = 1000;
  CellHarness cell(options);
  const auto begin = std::chrono::steady_clock::now();
  const bool out = cell.run_out(20'000 * kSecond);
  const auto took =
      std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - begin);
  std::printf("1,000 pieces: %lld s of plant time in %lld ms\n",
              static_cast<long long>(cell.now_ns() / kSecond), static_cast<long long>(took.count()));
  CHECK(out);
  CHECK(cell.complaint() == "");
  CHECK(cell.faults_raised() == 0);
  CHECK(cell.plant().ledger().verdict().stored_right == 1000);
}

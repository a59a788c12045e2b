// Statistics of durations, against a sorted list of the same durations.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "scan/histogram.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// The value at or below which the share lies: the definition, on a sorted list.
std::int64_t quantile_of(const std::vector<std::int64_t>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

void check_against_list(std::vector<std::int64_t> values) {
  const auto histogram = std::make_unique<Histogram>();
  std::int64_t sum = 0;
  for (const std::int64_t v : values) {
    histogram->record(v);
    sum += v;
  }
  std::sort(values.begin(), values.end());
  CHECK(histogram->count() == values.size());
  CHECK(histogram->min_ns() == values.front());
  CHECK(histogram->max_ns() == values.back());
  CHECK(histogram->mean_ns() == sum / static_cast<std::int64_t>(values.size()));
  for (const double share : {0.0, 0.001, 0.1, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const std::int64_t exact = quantile_of(values, share);
    const std::int64_t told = histogram->quantile_ns(share);
    CAPTURE(share);
    CHECK(told >= exact);
    CHECK(static_cast<double>(told - exact) <= 0.01 * static_cast<double>(exact));
  }
}

std::vector<std::int64_t> random_values(double mean_log, double spread, int count) {
  std::mt19937_64 random(42);
  std::lognormal_distribution<double> shape(mean_log, spread);
  std::vector<std::int64_t> values;
  for (int i = 0; i < count; ++i) values.push_back(static_cast<std::int64_t>(std::min(shape(random), 8e12)));
  return values;
}

TEST_CASE("quantiles of microseconds differ from a sorted list by 1 % at most [SCAN-6]") {
  check_against_list(random_values(std::log(20e3), 1.5, 100'000));
}

TEST_CASE("quantiles of values above a second differ from a sorted list by 1 % at most [SCAN-6]") {
  check_against_list(random_values(std::log(5e9), 2.0, 50'000));
}

TEST_CASE("quantiles of a single value are that value [SCAN-6]") {
  for (const std::int64_t v : {std::int64_t{0}, std::int64_t{1}, std::int64_t{127}, std::int64_t{128},
                               std::int64_t{999'999'999}, 3 * kSecond / 2, 3600 * kSecond})
    check_against_list({v});
}

TEST_CASE("quantiles at the edges of buckets stay within 1 % [SCAN-6]") {
  for (int bit = 1; bit < 43; ++bit) {
    const std::int64_t power = std::int64_t{1} << bit;
    check_against_list({power - 1, power, power + 1});
  }
}

TEST_CASE("small values are told exactly [SCAN-6]") {
  Histogram histogram;
  for (std::int64_t v = 0; v < 128; ++v) histogram.record(v);
  CHECK(histogram.quantile_ns(0.5) == 63);
  CHECK(histogram.quantile_ns(1.0) == 127);
}

TEST_CASE("empty histogram tells zero [SCAN-6]") {
  const Histogram histogram;
  CHECK(histogram.count() == 0);
  CHECK(histogram.min_ns() == 0);
  CHECK(histogram.max_ns() == 0);
  CHECK(histogram.mean_ns() == 0);
  CHECK(histogram.quantile_ns(0.99) == 0);
}

TEST_CASE("negative value counts as zero [SCAN-6]") {
  Histogram histogram;
  histogram.record(-5);
  CHECK(histogram.count() == 1);
  CHECK(histogram.min_ns() == 0);
  CHECK(histogram.max_ns() == 0);
}

TEST_CASE("value above the greatest bucket is told as the maximum [SCAN-6]") {
  Histogram histogram;
  histogram.record(100);
  histogram.record(std::int64_t{1} << 50);
  CHECK(histogram.count() == 2);
  CHECK(histogram.max_ns() == std::int64_t{1} << 50);
  CHECK(histogram.quantile_ns(1.0) == std::int64_t{1} << 50);
  CHECK(histogram.quantile_ns(0.5) == 100);
}

TEST_CASE("share outside 0..1 is taken as the nearest [SCAN-6]") {
  Histogram histogram;
  histogram.record(10);
  histogram.record(20);
  CHECK(histogram.quantile_ns(-1.0) == 10);
  CHECK(histogram.quantile_ns(2.0) == 20);
}

TEST_CASE("reader beside the writer never sees what cannot be [SCAN-6]") {
  const auto histogram = std::make_unique<Histogram>();
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (int i = 0; i < 2'000'000; ++i) histogram->record(1'000 + i % 5'000);
    done = true;
  });
  std::uint64_t last = 0;
  std::uint64_t wrong = 0;
  while (!done) {
    const std::uint64_t count = histogram->count();
    wrong += count < last;
    last = count;
    if (count == 0) continue;
    const std::int64_t median = histogram->quantile_ns(0.5);
    wrong += median < 1'000 || median > 6'100;
    wrong += histogram->min_ns() != 1'000;
    wrong += histogram->mean_ns() < 1'000;
  }
  writer.join();
  CHECK(wrong == 0);
  CHECK(histogram->count() == 2'000'000);
}

}  // namespace
}  // namespace stationd

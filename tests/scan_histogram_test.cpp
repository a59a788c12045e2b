// Statistics of durations, against a sorted list of the same durations; the last minute; a reader beside the
// writer.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "scan/statistics.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
using enum Window;

/// A histogram and its reader.
struct Rig {
  std::unique_ptr<Histogram> histogram = std::make_unique<Histogram>();
  HistogramReader reader{*histogram};
  std::int64_t now_ns = 100 * kSecond;

  void record(std::int64_t value_ns, int times = 1) const {
    for (int i = 0; i < times; ++i) histogram->record(value_ns);
  }
  void pass(std::int64_t seconds) {
    for (std::int64_t i = 0; i < seconds; ++i) reader.collect(now_ns += kSecond);
  }
  Summary told(Window window = since_start) {
    reader.collect(now_ns);
    return reader.summary(window);
  }
};

/// The value at or below which the share lies: the definition, on a sorted list.
std::int64_t quantile_of(const std::vector<std::int64_t>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

bool within(std::int64_t told, std::int64_t exact, double share) {
  return std::abs(static_cast<double>(told - exact)) <= share * static_cast<double>(exact);
}

void check_against_list(std::vector<std::int64_t> values) {
  Rig rig;
  std::int64_t sum = 0;
  for (const std::int64_t v : values) {
    rig.record(v);
    sum += v;
  }
  std::sort(values.begin(), values.end());
  for (const Window window : {since_start, last_minute}) {
    CAPTURE(name_of(window));
    const Summary told = rig.told(window);
    CHECK(told.count == values.size());
    CHECK(told.mean_ns == sum / static_cast<std::int64_t>(values.size()));
    CHECK(within(told.p50_ns, quantile_of(values, 0.5), 0.01));
    CHECK(within(told.p99_ns, quantile_of(values, 0.99), 0.01));
    CHECK(within(told.p999_ns, quantile_of(values, 0.999), 0.01));
    CHECK(within(told.min_ns, values.front(), 0.01));
    CHECK(within(told.max_ns, values.back(), 0.01));
  }
  CHECK(rig.told().min_ns == values.front());
  CHECK(rig.told().max_ns == values.back());
}

std::vector<std::int64_t> random_values(double mean_log, double spread, int count) {
  std::mt19937_64 random(42);
  std::lognormal_distribution<double> shape(mean_log, spread);
  std::vector<std::int64_t> values;
  for (int i = 0; i < count; ++i) values.push_back(static_cast<std::int64_t>(std::min(shape(random), 270e9)));
  return values;
}

TEST_CASE("figures of microseconds differ from a sorted list by 1 % at most [SCAN-6]") {
  check_against_list(random_values(std::log(20e3), 1.5, 100'000));
}

TEST_CASE("figures of values above a second differ from a sorted list by 1 % at most [SCAN-6]") {
  check_against_list(random_values(std::log(5e9), 1.5, 50'000));
}

TEST_CASE("figures of values over nine decades differ from a sorted list by 1 % at most [SCAN-6]") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(2.0, 11.0);  // 100 ns to 100 s
  for (const int count : {1, 2, 10, 999, 1'000, 1'001, 200'000}) {
    CAPTURE(count);
    std::vector<std::int64_t> values;
    for (int i = 0; i < count; ++i)
      values.push_back(static_cast<std::int64_t>(std::pow(10.0, exponent(random))));
    check_against_list(values);
  }
}

TEST_CASE("figures of a single value are that value [SCAN-6]") {
  for (const std::int64_t v : {std::int64_t{0}, std::int64_t{1}, std::int64_t{127}, std::int64_t{128},
                               std::int64_t{999'999'999}, 3 * kSecond / 2, 3600 * kSecond}) {
    Rig rig;
    rig.record(v, 3);
    CAPTURE(v);
    for (const Window window : {since_start, last_minute}) {
      const Summary told = rig.told(window);
      CHECK(told.count == 3);
      for (const std::int64_t ns : {told.min_ns, told.mean_ns, told.p50_ns, told.p999_ns, told.max_ns})
        CHECK(ns == v);
    }
  }
}

TEST_CASE("bucket of each value holds it, and its middle is within 0.8 % [SCAN-6]") {
  std::uint64_t outside = 0, far = 0;
  for (int bit = 0; bit < Buckets::kMaxBits; ++bit) {
    for (std::int64_t step = 0; step < 1'000; ++step) {
      const std::int64_t power = std::int64_t{1} << bit;
      const std::int64_t value = power + power * step / 1'000;
      const std::size_t bucket = Buckets::index(value);
      outside += value < Buckets::low_ns(bucket) || value >= Buckets::low_ns(bucket + 1);
      far += !within(Buckets::middle_ns(bucket), value, 1.0 / 128);
    }
  }
  CHECK(outside == 0);
  CHECK(far == 0);
  for (std::size_t i = 0; i < Buckets::kCount; ++i) CHECK(Buckets::index(Buckets::low_ns(i)) == i);
  for (std::int64_t v = 0; v < 128; ++v) CHECK(Buckets::middle_ns(Buckets::index(v)) == v);
}

TEST_CASE("empty histogram tells zero [SCAN-6]") {
  Rig rig;
  const Summary told = rig.told();
  for (const std::int64_t ns : {told.min_ns, told.mean_ns, told.p50_ns, told.p99_ns, told.max_ns})
    CHECK(ns == 0);
  CHECK(told.count == 0);
  CHECK(rig.reader.buckets(since_start).empty());
}

TEST_CASE("negative value counts as zero [SCAN-6]") {
  Rig rig;
  rig.record(-5);
  CHECK(rig.told().count == 1);
  CHECK(rig.told().min_ns == 0);
  CHECK(rig.told().max_ns == 0);
}

TEST_CASE("value above the greatest bucket counts in the overflow and the maximum stays exact [SCAN-6]") {
  Rig rig;
  rig.record(100, 9);
  rig.record(Buckets::low_ns(Buckets::kOverflow));
  rig.record(std::int64_t{1} << 50);
  const Summary told = rig.told();
  CHECK(told.count == 11);
  CHECK(told.max_ns == std::int64_t{1} << 50);
  CHECK(told.p99_ns == std::int64_t{1} << 50);
  CHECK(told.p50_ns == 100);
  CHECK(rig.reader.buckets(since_start).back().bucket == Buckets::kOverflow);
  CHECK(rig.reader.buckets(since_start).back().count == 2);
}

TEST_CASE("last minute forgets what is older than 70 s and keeps what is younger than 60 s [SCAN-6]") {
  Rig rig;
  rig.record(5 * kSecond, 7);
  rig.pass(1);
  rig.record(1'000, 100);
  rig.pass(58);
  CHECK(rig.told(last_minute).count == 107);
  CHECK(within(rig.told(last_minute).max_ns, 5 * kSecond, 0.01));
  rig.record(2'000, 10);
  rig.pass(12);
  const Summary minute = rig.told(last_minute);
  CHECK(minute.count == 10);
  CHECK(within(minute.max_ns, 2'000, 0.01));
  CHECK(minute.mean_ns >= minute.min_ns);
  CHECK(minute.mean_ns <= minute.max_ns);
  CHECK(rig.told(since_start).count == 117);
  CHECK(rig.told(since_start).max_ns == 5 * kSecond);
  rig.pass(70);
  CHECK(rig.told(last_minute).count == 0);
  CHECK(rig.told(last_minute).p99_ns == 0);
}

TEST_CASE("last minute is right beside a reader that looked away for an hour [SCAN-6]") {
  Rig rig;
  rig.record(1'000);
  rig.pass(1);
  rig.now_ns += 3600 * kSecond;
  rig.record(3'000);
  CHECK(rig.told(last_minute).count == 1);
  rig.now_ns -= 100 * kSecond;  // a clock that goes back stands still
  rig.record(3'000);
  CHECK(rig.told(last_minute).count == 2);
}

TEST_CASE("last minute of a random run is that of a list with times [SCAN-6]") {
  Rig rig;
  std::mt19937_64 random(3);
  std::vector<std::int64_t> values;
  for (std::uint64_t second = 0; second < 600; ++second) {
    const int n = static_cast<int>(random() % 300);
    for (int i = 0; i < n; ++i) {
      const auto value = static_cast<std::int64_t>(1'000 + random() % 1'000'000 * (1 + second / 100));
      rig.record(value);
      if (second >= 539) values.push_back(value);  // collected at 640 s and later; it ends at 700 s
    }
    rig.pass(1);
  }
  std::sort(values.begin(), values.end());
  const Summary told = rig.told(last_minute);
  CHECK(told.count == values.size());
  CHECK(within(told.p50_ns, quantile_of(values, 0.5), 0.01));
  CHECK(within(told.p99_ns, quantile_of(values, 0.99), 0.01));
  CHECK(within(told.max_ns, values.back(), 0.01));
}

TEST_CASE("counter tells by how much it grew in the last minute [SCAN-6]") {
  CounterReader counter;
  std::int64_t now_ns = 1'000 * kSecond;
  counter.collect(5, now_ns);
  counter.collect(8, now_ns += 59 * kSecond);
  CHECK(counter.value(last_minute) == 8);
  counter.collect(9, now_ns += 12 * kSecond);
  CHECK(counter.value(last_minute) == 4);
  CHECK(counter.value(since_start) == 9);
}

TEST_CASE("counts of a bucket go on beyond the 32 bits that the scan keeps [SCAN-6]") {
  Rig rig;
  const auto reading = std::make_unique<Histogram::Reading>();
  reading->min_ns = reading->max_ns = 50;
  reading->first = reading->last = 50;
  for (int i = 0; i < 10; ++i) {
    reading->count += 3'000'000'000U;
    reading->sum_ns += 150'000'000'000U;
    reading->buckets[50] += 3'000'000'000U;
    rig.reader.take(*reading, rig.now_ns += 10 * kSecond);
  }
  const Summary told = rig.reader.summary(since_start);
  CHECK(told.count == 30'000'000'000ULL);
  CHECK(told.mean_ns == 50);
  CHECK(rig.reader.summary(last_minute).count == 21'000'000'000ULL);
}

TEST_CASE("a histogram takes under 9 kB in the scan's memory [SCAN-6]") {
  CHECK(sizeof(Histogram) <= 9 * 1024);
  CHECK(sizeof(StationFigures) <= 18 * 1024);
}

TEST_CASE("reader beside the writer never sees what cannot be [SCAN-6]") {
  Rig rig;
  constexpr int kValues = 5'000'000;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (int i = 0; i < kValues; ++i) rig.histogram->record(1'000 + i % 5'000);
    done = true;
  });
  std::uint64_t last = 0, wrong = 0, looks = 0;
  const auto reading = std::make_unique<Histogram::Reading>();
  while (!done) {
    const std::uint64_t before = rig.histogram->count();
    const bool whole = rig.histogram->read(*reading);
    std::uint64_t sum = 0;
    if (before > 0)
      for (std::size_t i = reading->first; i <= reading->last; ++i) sum += reading->buckets[i];
    wrong += whole && sum != reading->count;
    wrong += sum < before;
    const Summary told = rig.told();
    wrong += told.count < last;
    last = told.count;
    if (told.count == 0) continue;
    ++looks;
    wrong += told.p50_ns < 1'000 || told.p999_ns > 6'000 || told.min_ns != 1'000 || told.max_ns > 5'999;
    wrong += told.mean_ns < told.min_ns || told.mean_ns > told.max_ns;
  }
  writer.join();
  CHECK(wrong == 0);
  CHECK(looks > 0);
  const Summary told = rig.told();
  CHECK(told.count == kValues);
  CHECK(told.mean_ns == 1'000 + 4'999 / 2);
  CHECK(rig.told(last_minute).count == kValues);
}

TEST_CASE("reader between two records of a paced writer always reads one moment [SCAN-6]") {
  Rig rig;
  std::atomic<std::uint64_t> turn{0};
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= 2'000; ++i) {
      for (int n = 0; n < 3; ++n) rig.histogram->record(static_cast<std::int64_t>(i) * 1'000);
      turn = i;
      while (turn != 0) std::this_thread::yield();
    }
  });
  std::uint64_t wrong = 0;
  const auto reading = std::make_unique<Histogram::Reading>();
  for (std::uint64_t i = 1; i <= 2'000; ++i) {
    while (turn != i) std::this_thread::yield();
    wrong += !rig.histogram->read(*reading) || reading->count != 3 * i;
    wrong += reading->sum_ns != 3'000 * (i * (i + 1) / 2);
    wrong += rig.told().count != 3 * i;
    turn = 0;
  }
  writer.join();
  CHECK(wrong == 0);
}

TEST_CASE("recording ten million values counts each, and prints what one costs [SCAN-6]") {
  Rig rig;
  constexpr int kValues = 10'000'000;
  std::mt19937_64 random(1);
  std::vector<std::int64_t> values;
  for (int i = 0; i < 4096; ++i) values.push_back(static_cast<std::int64_t>(random() % 1'000'000));
  const auto begin = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < kValues; ++i) rig.histogram->record(values[i % values.size()]);
  const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
  MESSAGE("one record: " << took.count() / kValues << " ns");
  CHECK(rig.told().count == kValues);
}

}  // namespace
}  // namespace stationd

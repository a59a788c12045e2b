// Histogram: durations in log-linear buckets of fixed number, with a bounded relative error.
// Owned by a task's statistics.
// One writer thread, any number of reader threads; never allocates, wait-free on both sides.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstdint>

#include "scan/nonblocking.hpp"

namespace stationd {

/// Each power of two is cut into 128 buckets: a value is told within 1/128 (0.8 %). Negative values count as
/// 0; the greatest told apart is 2^43 ns (2.4 h).
class Histogram {
 public:
  /// Writer thread.
  void record(std::int64_t value_ns) noexcept STATIOND_NONBLOCKING {
    if (value_ns < 0) value_ns = 0;
    // What a reader derives from the count or a bucket is written before it, so that it never lags behind.
    if (value_ns > max_ns_.load(std::memory_order_relaxed))
      max_ns_.store(value_ns, std::memory_order_relaxed);
    if (value_ns < min_ns_.load(std::memory_order_relaxed))
      min_ns_.store(value_ns, std::memory_order_relaxed);
    add(sum_ns_, static_cast<std::uint64_t>(value_ns));
    add(buckets_[index(value_ns)], 1);
    add(count_, 1);
  }

  std::uint64_t count() const noexcept { return count_.load(std::memory_order_acquire); }
  std::int64_t max_ns() const noexcept { return max_ns_.load(std::memory_order_relaxed); }
  /// 0 while nothing was recorded.
  std::int64_t min_ns() const noexcept { return count() == 0 ? 0 : min_ns_.load(std::memory_order_relaxed); }
  std::int64_t mean_ns() const noexcept {
    const std::uint64_t n = count();
    return n == 0 ? 0 : static_cast<std::int64_t>(sum_ns_.load(std::memory_order_relaxed) / n);
  }
  /// The value below or at which the share `quantile` (0..1) of the recorded ones lies: a bucket's upper end,
  /// at most max_ns().
  std::int64_t quantile_ns(double quantile) const noexcept;

 private:
  static constexpr int kSubBits = 7;
  static constexpr std::uint64_t kSub = 1U << kSubBits;
  static constexpr int kMaxBits = 43;
  static constexpr std::size_t kBuckets = kSub * (kMaxBits - kSubBits + 1);

  static void add(std::atomic<std::uint64_t>& to, std::uint64_t n) noexcept {
    to.store(to.load(std::memory_order_relaxed) + n, std::memory_order_release);
  }
  static std::size_t index(std::int64_t value_ns) noexcept STATIOND_NONBLOCKING;
  static std::int64_t upper_ns(std::size_t index) noexcept;

  std::array<std::atomic<std::uint64_t>, kBuckets> buckets_{};
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::uint64_t> sum_ns_{0};
  std::atomic<std::int64_t> max_ns_{0};
  std::atomic<std::int64_t> min_ns_{INT64_MAX};
};

}  // namespace stationd

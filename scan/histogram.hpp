// Histogram: durations counted in log-linear buckets of fixed number, with a bounded relative error.
// Owned by a task's statistics; read elsewhere by a HistogramReader (statistics.hpp).
// One writer thread (the scan) and one reader thread; never allocates, wait-free for the writer.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "scan/nonblocking.hpp"

namespace stationd {

/// Where a duration is counted: below 128 ns exactly, above that each power of two is cut into 64 buckets, of
/// which the middle is told: at most 1/128 (0.8 %) off, either way. What takes 2^38 ns (275 s, beyond four of
/// the longest periods) or more counts in one last bucket, the overflow; negative values count as 0.
struct Buckets {
  static constexpr int kSubBits = 6;
  static constexpr int kMaxBits = 38;
  static constexpr std::uint64_t kSub = 1U << kSubBits;
  static constexpr std::size_t kOverflow = kSub * (kMaxBits - kSubBits + 1);
  static constexpr std::size_t kCount = kOverflow + 1;

  static constexpr std::size_t index(std::int64_t value_ns) noexcept {
    const auto v = static_cast<std::uint64_t>(value_ns < 0 ? 0 : value_ns);
    const int top =
        static_cast<int>(std::bit_width(v | kSub)) - 1;  // at least kSubBits: the first two blocks are linear
    if (top >= kMaxBits) return kOverflow;
    const int shift = top - kSubBits;
    return static_cast<std::size_t>((static_cast<std::uint64_t>(shift) << kSubBits) + (v >> shift));
  }
  /// The least value counted in bucket `index`; that of kCount is where the overflow would end: never.
  static constexpr std::int64_t low_ns(std::size_t index) noexcept {
    if (index >= kCount) return INT64_MAX;
    const std::uint64_t shift = index < 2 * kSub ? 0 : index / kSub - 1;
    return static_cast<std::int64_t>((index - shift * kSub) << shift);
  }
  /// What a value of the bucket is told as. Of the overflow: its least; the caller knows the maximum.
  static constexpr std::int64_t middle_ns(std::size_t index) noexcept {
    if (index >= kOverflow) return low_ns(kOverflow);
    return low_ns(index) + (low_ns(index + 1) - low_ns(index)) / 2;
  }
};

class Histogram {
 public:
  /// Writer thread.
  void record(std::int64_t value_ns) noexcept STATIOND_NONBLOCKING {
    if (value_ns < 0) value_ns = 0;
    const std::uint64_t n = done_.load(std::memory_order_relaxed) + 1;
    begun_.store(n, std::memory_order_relaxed);
    // Each store releases: who sees one of them sees that this record has begun. See read().
    if (value_ns > max_ns_.load(std::memory_order_relaxed))
      max_ns_.store(value_ns, std::memory_order_release);
    if (value_ns < min_ns_.load(std::memory_order_relaxed))
      min_ns_.store(value_ns, std::memory_order_release);
    sum_ns_.store(sum_ns_.load(std::memory_order_relaxed) + static_cast<std::uint64_t>(value_ns),
                  std::memory_order_release);
    std::atomic<std::uint32_t>& bucket = buckets_[Buckets::index(value_ns)];
    bucket.store(bucket.load(std::memory_order_relaxed) + 1, std::memory_order_release);
    done_.store(n, std::memory_order_release);
  }

  /// What the buckets held at one moment. Their counts wrap at 2^32: whoever adds up the differences of two
  /// readings has them whole, if he looks once in 2^32 records (12 days of one bucket at 250 us).
  struct Reading {
    std::uint64_t count = 0;
    std::uint64_t sum_ns = 0;
    std::int64_t min_ns = 0, max_ns = 0;
    std::size_t first = 0, last = 0;  ///< the buckets that hold anything lie between, inclusive
    std::array<std::uint32_t, Buckets::kCount> buckets{};  ///< filled from first to last
  };
  /// Any thread but the writer's. True: of one moment, between two records. False: records went on all the
  /// while, as no scan does; then each bucket is right by itself, and the sum may be ahead of or behind them.
  bool read(Reading& reading) const noexcept;

  /// Any thread. Values recorded.
  std::uint64_t count() const noexcept { return done_.load(std::memory_order_acquire); }
  /// Any thread; exact. 0 while nothing was recorded.
  std::int64_t max_ns() const noexcept { return max_ns_.load(std::memory_order_relaxed); }

 private:
  static constexpr int kReadTries = 4;
  static constexpr std::size_t kCacheLine = 64;

  bool read_once(Reading& reading) const noexcept;

  alignas(kCacheLine) std::atomic<std::uint64_t> begun_{0};
  std::atomic<std::uint64_t> done_{0};
  std::atomic<std::uint64_t> sum_ns_{0};
  std::atomic<std::int64_t> max_ns_{0};
  std::atomic<std::int64_t> min_ns_{INT64_MAX};
  alignas(kCacheLine) std::array<std::atomic<std::uint32_t>, Buckets::kCount> buckets_{};
};

}  // namespace stationd

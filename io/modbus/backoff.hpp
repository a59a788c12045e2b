// Backoff: when to try a failing device again: after 0.1 s, doubling to 5 s, each off by up to a quarter.
// Owned by the device's backend.
// Takes the time as a value; the device thread.
#pragma once

#include <algorithm>
#include <cstdint>

namespace stationd::io::modbus {

class Backoff {
 public:
  static constexpr std::int64_t kFirstNs = 100'000'000, kMostNs = 5'000'000'000;

  /// `seed`: differs between devices, so that many behind one switch do not come back in one moment.
  explicit Backoff(std::uint64_t seed) noexcept : random_(seed * 2 + 1) {}

  bool may_try(std::int64_t now_ns) const noexcept { return now_ns >= next_ns_; }
  /// The next attempt is due at once.
  void forget() noexcept {
    wait_ns_ = kFirstNs;
    next_ns_ = INT64_MIN;
  }
  void succeeded() noexcept { wait_ns_ = kFirstNs; }
  void failed(std::int64_t now_ns) noexcept {
    random_ = random_ * 6364136223846793005U + 1442695040888963407U;
    const auto jitter_percent = static_cast<std::int64_t>((random_ >> 33U) % 51) - 25;
    next_ns_ = now_ns + wait_ns_ + wait_ns_ * jitter_percent / 100;
    wait_ns_ = std::min(wait_ns_ * 2, kMostNs);
  }

 private:
  std::uint64_t random_;
  std::int64_t wait_ns_ = kFirstNs;
  std::int64_t next_ns_ = INT64_MIN;
};

}  // namespace stationd::io::modbus

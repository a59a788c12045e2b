// Ring: a bounded queue of records from one thread to another; nothing is lost silently.
// Owned by the station (or task) whose records it carries.
// Exactly one producer thread and one consumer thread; both sides are wait-free and never allocate.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

#include "scan/nonblocking.hpp"

namespace stationd {

template <class T> class Ring {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Set-up only (allocates). Holds at least `capacity` records (rounded up to a power of two).
  explicit Ring(std::size_t capacity)
      : mask_(std::bit_ceil(capacity < 2 ? 2 : capacity) - 1), items_(new T[mask_ + 1]) {}
  Ring(const Ring&) = delete;
  Ring& operator=(const Ring&) = delete;

  /// Producer thread. False when full: the record is not taken and dropped() counts it.
  bool push(const T& item) noexcept STATIOND_NONBLOCKING {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (full()) {
      dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      return false;
    }
    items_[tail & mask_] = item;
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  /// Producer thread. Whether a push() now would be refused.
  bool full() noexcept STATIOND_NONBLOCKING {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail - head_cache_ <= mask_) return false;
    head_cache_ = head_.load(std::memory_order_acquire);
    return tail - head_cache_ > mask_;
  }

  /// Producer thread. Records that fit now.
  std::size_t room() noexcept STATIOND_NONBLOCKING {
    head_cache_ = head_.load(std::memory_order_acquire);
    return capacity() - (tail_.load(std::memory_order_relaxed) - head_cache_);
  }

  /// Consumer thread. False when empty.
  bool pop(T& item) noexcept STATIOND_NONBLOCKING {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_cache_) {
      tail_cache_ = tail_.load(std::memory_order_acquire);
      if (head == tail_cache_) return false;
    }
    item = items_[head & mask_];
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// Consumer thread. The oldest record, left in place; null when empty. Valid until pop().
  const T* peek() noexcept STATIOND_NONBLOCKING {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_cache_) {
      tail_cache_ = tail_.load(std::memory_order_acquire);
      if (head == tail_cache_) return nullptr;
    }
    return &items_[head & mask_];
  }

  /// Any thread. Records refused because the ring was full, since set-up.
  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }
  std::size_t capacity() const noexcept { return mask_ + 1; }

 private:
  static constexpr std::size_t kAlign = 64;
  std::size_t mask_;
  std::unique_ptr<T[]> items_;
  alignas(kAlign) std::atomic<std::size_t> tail_{0};
  std::size_t head_cache_ = 0;  // producer's
  std::atomic<std::uint64_t> dropped_{0};
  alignas(kAlign) std::atomic<std::size_t> head_{0};
  std::size_t tail_cache_ = 0;  // consumer's
};

}  // namespace stationd

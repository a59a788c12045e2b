// Snapshot: hands the newest block of bytes from one thread to another; the latest wins.
// Owned by the station (or task) whose data it carries; writer and reader hold a reference.
// Exactly one writer thread and one reader thread; both sides are wait-free and never allocate.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "scan/nonblocking.hpp"

namespace stationd {

class Snapshot {
 public:
  /// Set-up only (allocates). Three buffers of `size_bytes`, zeroed, each 64-byte aligned.
  explicit Snapshot(std::size_t size_bytes);
  Snapshot(const Snapshot&) = delete;
  Snapshot& operator=(const Snapshot&) = delete;

  std::size_t size_bytes() const noexcept { return size_bytes_; }

  /// Writer thread. The buffer to fill; its old content is undefined. The same one until publish().
  std::byte* writable() noexcept STATIOND_NONBLOCKING { return buffer(back_); }

  /// Writer thread. Makes the filled buffer the newest. True if the one before it was overtaken, that is
  /// never seen by the reader (count it where that matters). The very first publish returns false.
  bool publish() noexcept STATIOND_NONBLOCKING {
    const std::uint32_t old = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel);
    back_ = old & kIndex;
    return (old & kFresh) != 0;
  }

  /// Reader thread. Takes over the newest block if there is one that was not seen yet; true if so.
  bool update() noexcept STATIOND_NONBLOCKING {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    const std::uint32_t old = middle_.exchange(front_, std::memory_order_acq_rel);
    front_ = old & kIndex;
    return true;
  }

  /// Reader thread. The block of the last update(); zeroes before the first. Unchanged until update().
  const std::byte* readable() const noexcept STATIOND_NONBLOCKING { return buffer(front_); }

 private:
  static constexpr std::uint32_t kFresh = 4;
  static constexpr std::uint32_t kIndex = 3;
  static constexpr std::size_t kAlign = 64;

  std::byte* buffer(std::uint32_t index) const noexcept { return base_ + index * stride_; }

  std::size_t size_bytes_;
  std::size_t stride_;
  std::unique_ptr<std::byte[]> storage_;
  std::byte* base_;
  alignas(kAlign) std::uint32_t back_ = 0;                // writer's
  alignas(kAlign) std::atomic<std::uint32_t> middle_{1};  // shared
  alignas(kAlign) std::uint32_t front_ = 2;               // reader's
};

/// A snapshot of one trivially copyable record.
template <class T> class Latest {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Latest() : snapshot_(sizeof(T)) {}
  /// Writer thread. True if the record before it was overtaken.
  bool publish(const T& value) noexcept STATIOND_NONBLOCKING {
    *reinterpret_cast<T*>(snapshot_.writable()) = value;
    return snapshot_.publish();
  }
  /// Reader thread. True if `value` was replaced by one not seen before.
  bool take(T& value) noexcept STATIOND_NONBLOCKING {
    if (!snapshot_.update()) return false;
    value = *reinterpret_cast<const T*>(snapshot_.readable());
    return true;
  }

 private:
  Snapshot snapshot_;
};

}  // namespace stationd

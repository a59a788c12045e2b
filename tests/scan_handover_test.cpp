// The two hand-overs between threads: snapshot and ring. Run under TSan, too.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <thread>

#include "scan/links.hpp"
#include "scan/ring.hpp"
#include "scan/snapshot.hpp"

namespace stationd {
namespace {

struct Block {
  std::array<std::uint64_t, 33> words{};
};

Block block_of(std::uint64_t n) {
  Block block;
  block.words.fill(n);
  return block;
}

bool whole(const Block& block) {
  return std::all_of(block.words.begin(), block.words.end(),
                     [&](std::uint64_t word) { return word == block.words[0]; });
}

TEST_CASE("snapshot that was never published gives nothing new and zeroes") {
  Snapshot snapshot(16);
  CHECK_FALSE(snapshot.update());
  CHECK(std::to_integer<int>(snapshot.readable()[15]) == 0);
  CHECK(snapshot.size_bytes() == 16);
}

TEST_CASE("snapshot buffers are aligned and apart, whatever their size") {
  for (const std::size_t size : {1UL, 63UL, 64UL, 65UL, 1000UL}) {
    Snapshot snapshot(size);
    for (int i = 0; i < 4; ++i) {
      CHECK(reinterpret_cast<std::uintptr_t>(snapshot.writable()) % 64 == 0);
      CHECK(snapshot.writable() != snapshot.readable());
      std::memset(snapshot.writable(), i, size);
      snapshot.publish();
      snapshot.update();
      CHECK(std::to_integer<int>(snapshot.readable()[size - 1]) == i);
    }
  }
}

TEST_CASE("snapshot published twice gives the newest and tells the overtaken one") {
  Latest<int> latest;
  int value = 0;
  CHECK_FALSE(latest.publish(1));
  CHECK(latest.publish(2));
  CHECK(latest.take(value));
  CHECK(value == 2);
  CHECK_FALSE(latest.publish(3));
}

TEST_CASE("snapshot that was taken stays readable until the next update") {
  Latest<int> latest;
  int value = 0;
  latest.publish(1);
  CHECK(latest.take(value));
  CHECK_FALSE(latest.take(value));
  CHECK(value == 1);
}

TEST_CASE("snapshot under two threads is never torn, never goes back, and counts what was overtaken") {
  constexpr std::uint64_t kCount = 3'000'000;
  Latest<Block> latest;
  std::atomic<bool> done{false};
  std::uint64_t overtaken = 0;
  std::thread writer([&] {
    for (std::uint64_t n = 1; n <= kCount; ++n) overtaken += latest.publish(block_of(n));
    done = true;
  });
  std::uint64_t seen = 0;
  std::uint64_t last = 0;
  std::uint64_t torn = 0;
  std::uint64_t backward = 0;
  const auto look = [&] {
    Block block;
    if (!latest.take(block)) return;
    ++seen;
    torn += !whole(block);
    backward += block.words[0] <= last;
    last = block.words[0];
  };
  while (!done) look();
  writer.join();
  look();
  CHECK(torn == 0);
  CHECK(backward == 0);
  CHECK(last == kCount);
  CHECK(seen + overtaken == kCount);
}

TEST_CASE("ring gives records back in order, then is empty") {
  Ring<int> ring(4);
  int value = 0;
  CHECK_FALSE(ring.pop(value));
  CHECK(ring.peek() == nullptr);
  for (int i = 0; i < 3; ++i) CHECK(ring.push(i));
  CHECK(*ring.peek() == 0);
  for (int i = 0; i < 3; ++i) {
    CHECK(ring.pop(value));
    CHECK(value == i);
  }
  CHECK_FALSE(ring.pop(value));
}

TEST_CASE("ring that is full refuses the record, counts it, and goes on when there is room") {
  Ring<int> ring(4);
  int value = 0;
  for (int i = 0; i < 4; ++i) CHECK(ring.push(i));
  CHECK(ring.full());
  CHECK_FALSE(ring.push(99));
  CHECK_FALSE(ring.push(99));
  CHECK(ring.dropped() == 2);
  CHECK(ring.pop(value));
  CHECK_FALSE(ring.full());
  CHECK(ring.push(4));
  for (int i = 1; i <= 4; ++i) {
    CHECK(ring.pop(value));
    CHECK(value == i);
  }
}

TEST_CASE("ring rounds its capacity up to a power of two") {
  CHECK(Ring<int>(0).capacity() == 2);
  CHECK(Ring<int>(2).capacity() == 2);
  CHECK(Ring<int>(5).capacity() == 8);
  CHECK(Ring<int>(64).capacity() == 64);
}

TEST_CASE("ring under two threads keeps order and loses nothing that it does not count") {
  constexpr std::uint64_t kCount = 3'000'000;
  Ring<Block> ring(16);
  std::atomic<bool> done{false};
  std::uint64_t taken = 0;
  std::thread producer([&] {
    for (std::uint64_t n = 1; n <= kCount; ++n) taken += ring.push(block_of(n));
    done = true;
  });
  std::uint64_t got = 0;
  std::uint64_t last = 0;
  std::uint64_t wrong = 0;
  const auto drain = [&] {
    Block block;
    while (ring.pop(block)) {
      ++got;
      wrong += !whole(block) || block.words[0] <= last;
      last = block.words[0];
    }
  };
  while (!done) drain();
  producer.join();
  drain();
  CHECK(wrong == 0);
  CHECK(got == taken);
  CHECK(got + ring.dropped() == kCount);
}

TEST_CASE("stop latch that was not set gives nothing [REQ-2]") {
  StopLatch latch;
  CHECK_FALSE(latch.pending());
  CHECK(latch.take().mode == StopMode::none);
}

TEST_CASE("stop latch keeps the strongest mode and the newest order until it is taken [REQ-2]") {
  StopLatch latch;
  latch.set(StopMode::immediate, 5);
  latch.set(StopMode::end_of_piece, 9);
  latch.set(StopMode::end_of_piece, 7);
  CHECK(latch.pending());
  const StopLatch::Taken taken = latch.take();
  CHECK(taken.mode == StopMode::immediate);
  CHECK(taken.order == 9);
  CHECK_FALSE(latch.pending());
  CHECK(latch.take().mode == StopMode::none);
}

TEST_CASE("stop latch under several threads loses no Stop [REQ-2]") {
  constexpr std::uint64_t kOrders = 200'000;
  StopLatch latch;
  std::atomic<int> running{2};
  const auto setter = [&](std::uint64_t first, StopMode mode) {
    for (std::uint64_t n = first; n <= kOrders; n += 2) latch.set(mode, n);
    --running;
  };
  std::thread even(setter, 2, StopMode::immediate);
  std::thread odd(setter, 1, StopMode::end_of_piece);
  std::uint64_t newest = 0;
  bool immediate = false;
  const auto look = [&] {
    const StopLatch::Taken taken = latch.take();
    newest = std::max(newest, taken.order);
    immediate |= taken.mode == StopMode::immediate;
  };
  while (running != 0) look();
  even.join();
  odd.join();
  look();
  CHECK(newest == kOrders);
  CHECK(immediate);
}

}  // namespace
}  // namespace stationd

#include "scan/histogram.hpp"

namespace stationd {

bool Histogram::read(Reading& reading) const noexcept {
  for (int i = 0; i < kReadTries; ++i)
    if (read_once(reading)) return true;
  return false;
}

/// Every load acquires: if it took what a later record wrote, the look at begun_ behind it sees that record.
bool Histogram::read_once(Reading& reading) const noexcept {
  reading.count = done_.load(std::memory_order_acquire);
  reading.sum_ns = sum_ns_.load(std::memory_order_acquire);
  reading.max_ns = max_ns_.load(std::memory_order_acquire);
  reading.min_ns = min_ns_.load(std::memory_order_acquire);
  if (reading.min_ns > reading.max_ns) reading.min_ns = reading.max_ns;  // nothing yet, or the very first
  reading.first = Buckets::index(reading.min_ns);
  reading.last = Buckets::index(reading.max_ns);
  for (std::size_t i = reading.first; i <= reading.last; ++i)
    reading.buckets[i] = buckets_[i].load(std::memory_order_acquire);
  return begun_.load(std::memory_order_relaxed) == reading.count;
}

}  // namespace stationd

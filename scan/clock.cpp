#include "scan/clock.hpp"

#include <time.h>

namespace stationd {
namespace {

std::int64_t clock_ns(clockid_t clock) noexcept STATIOND_NONBLOCKING {
  timespec t{};
  // No system call: the kernel maps these two clocks into the process (vdso(7)).
  STATIOND_TRUSTED(clock_gettime(clock, &t));
  return t.tv_sec * 1'000'000'000 + t.tv_nsec;
}

}  // namespace

std::int64_t monotonic_ns() noexcept { return clock_ns(CLOCK_MONOTONIC); }
std::int64_t utc_offset_ns() noexcept { return clock_ns(CLOCK_REALTIME) - clock_ns(CLOCK_MONOTONIC); }

}  // namespace stationd

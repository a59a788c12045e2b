// The two clocks of a Linux machine, in nanoseconds. The engine calls neither: it takes the time as a value.
// Owned by nobody.
// Any thread.
#pragma once

#include <cstdint>

#include "scan/nonblocking.hpp"

namespace stationd {

/// CLOCK_MONOTONIC. Unlike CLOCK_REALTIME it is never set.
std::int64_t monotonic_ns() noexcept STATIOND_NONBLOCKING;
/// CLOCK_REALTIME less CLOCK_MONOTONIC: added to a monotonic time it gives UTC since 1970.
std::int64_t utc_offset_ns() noexcept;

}  // namespace stationd

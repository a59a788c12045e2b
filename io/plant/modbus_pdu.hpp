// Answers Modbus/TCP requests from a plant's four units: framing, checks, function codes 1-6, 15, 16, 22, 23.
// No state of its own; encodes by itself, because the requests may be anything at all.
// The thread that steps the plant.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "io/plant/plant.hpp"

namespace stationd::plant {

inline constexpr std::size_t kAduMax = 260;  ///< 7 bytes of MBAP header, 253 of PDU

enum class FrameStatus : std::uint8_t { incomplete, complete, garbage };
struct Frame {
  FrameStatus status = FrameStatus::incomplete;
  std::size_t length = 0;  ///< of the first frame in the buffer, when complete
};

/// Looks at the first bytes received. `garbage`: not Modbus/TCP; there is no way to find the next frame.
Frame first_frame(std::span<const std::uint8_t> received) noexcept;

using Reply = std::array<std::uint8_t, kAduMax>;

/// Carries out one complete frame and encodes the answer; returns its length. Answers exception 1 for a
/// function that is not there, 2 for an address, 3 for a count or value, 0x0B for a unit other than 1 to 4.
std::size_t answer(Plant& plant, std::span<const std::uint8_t> frame, Reply& reply) noexcept;

}  // namespace stationd::plant

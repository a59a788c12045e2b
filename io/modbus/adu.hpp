// Adu: Modbus/TCP requests and replies as bytes: encodes the one, judges and decodes the other.
// Owned by the device's backend.
// Pure functions over the caller's buffers; the device thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "io/backend.hpp"
#include "io/options.hpp"

namespace stationd::io::modbus {

inline constexpr std::size_t kHeaderBytes = 7;  ///< transaction, protocol, length, unit
inline constexpr std::size_t kMaxAduBytes = 260;

/// A request as it goes out, and what its reply has to agree with.
struct Adu {
  std::array<std::uint8_t, kMaxAduBytes> bytes{};
  std::size_t size = 0;

  std::span<const std::uint8_t> view() const noexcept { return {bytes.data(), size}; }
  std::uint8_t function() const noexcept { return bytes[kHeaderBytes]; }
};

/// Who is asked, under which number.
struct Address {
  std::uint16_t transaction = 0;
  std::uint8_t unit = 1;
};

/// FC 1 to 4.
Adu read_request(Address to, Table table, std::uint16_t first, std::uint32_t count) noexcept;
/// FC 15 and 16 with all values 0; fill them in with put_bit and put_value.
Adu write_request(Address to, Table table, std::uint16_t first, std::uint32_t count) noexcept;
/// FC 6.
Adu write_register_request(Address to, std::uint16_t address, std::uint16_t value) noexcept;

/// Into a write request, `offset` bits or registers from its first.
void put_bit(Adu& request, std::uint32_t offset, bool value) noexcept;
void put_value(Adu& request, std::uint32_t offset, TagType type, Slot value) noexcept;

/// Whether `reply` answers `request`: transaction, protocol, length, unit, function, byte count or echo. ok,
/// protocol or exception (code: the exception's); `detail` says what was wrong.
ExchangeResult judge(const Adu& request, std::span<const std::uint8_t> reply) noexcept;

/// From the reply to a read that judge() found ok, `offset` bits or registers from its first.
bool bit_at(std::span<const std::uint8_t> reply, std::uint32_t offset) noexcept;
/// 8-bit types take the register's value, limited to their range; wider ones have the high word first.
Slot value_at(std::span<const std::uint8_t> reply, std::uint32_t offset, TagType type) noexcept;

}  // namespace stationd::io::modbus

#include "io/plant/modbus_pdu.hpp"

namespace stationd::plant {

namespace {

constexpr std::size_t kHeader = 7;  ///< transaction (2), protocol (2), length (2), unit (1)
constexpr std::size_t kLengthMin = 2;
constexpr std::size_t kLengthMax = 254;

constexpr std::uint8_t kIllegalFunction = 1;
constexpr std::uint8_t kIllegalAddress = 2;
constexpr std::uint8_t kIllegalValue = 3;
constexpr std::uint8_t kGatewayTarget = 0x0B;

constexpr std::size_t kReadBitsMax = 2000;
constexpr std::size_t kReadRegistersMax = 125;
constexpr std::size_t kWriteBitsMax = 1968;
constexpr std::size_t kWriteRegistersMax = 123;
constexpr std::size_t kReadWriteRegistersMax = 121;

using Bytes = std::span<const std::uint8_t>;

std::uint16_t word(Bytes bytes, std::size_t at) noexcept {
  return static_cast<std::uint16_t>((bytes[at] << 8) | bytes[at + 1]);
}

/// The PDU being answered: function code and data, then the reply's. An exception code ends the work.
struct Exchange {
  UnitIo& io;
  Bytes pdu;
  Reply& reply;
  std::size_t length = kHeader + 1;  ///< of the reply so far
  bool wrote = false;

  void byte(std::size_t value) noexcept { reply[length++] = static_cast<std::uint8_t>(value); }
  void put_word(std::size_t value) noexcept {
    byte(value >> 8);
    byte(value & 0xFF);
  }
  void echo(std::size_t bytes) noexcept {
    for (std::size_t i = 1; i <= bytes; ++i) byte(pdu[i]);
  }
};

std::uint8_t check(std::size_t first, std::size_t count, std::size_t count_max, std::size_t size) noexcept {
  if (count < 1 || count > count_max) return kIllegalValue;
  return first + count > size ? kIllegalAddress : std::uint8_t{0};
}

template <std::size_t N> std::uint8_t read_bits(Exchange& x, const std::array<bool, N>& bits) noexcept {
  if (x.pdu.size() != 5) return kIllegalValue;
  const std::size_t first = word(x.pdu, 1), count = word(x.pdu, 3);
  if (const std::uint8_t wrong = check(first, count, kReadBitsMax, N)) return wrong;
  x.byte((count + 7) / 8);
  for (std::size_t at = 0; at < count; at += 8) {
    unsigned packed = 0;
    for (std::size_t bit = 0; bit < 8 && at + bit < count; ++bit)
      packed |= unsigned{bits[first + at + bit]} << bit;
    x.byte(packed);
  }
  return 0;
}

void put_registers(Exchange& x, std::span<const std::uint16_t> registers) noexcept {
  x.byte(2 * registers.size());
  for (const std::uint16_t value : registers) x.put_word(value);
}

std::uint8_t read_registers(Exchange& x, std::span<const std::uint16_t> registers) noexcept {
  if (x.pdu.size() != 5) return kIllegalValue;
  const std::size_t first = word(x.pdu, 1), count = word(x.pdu, 3);
  if (const std::uint8_t wrong = check(first, count, kReadRegistersMax, registers.size())) return wrong;
  put_registers(x, registers.subspan(first, count));
  return 0;
}

std::uint8_t write_coil(Exchange& x) noexcept {
  if (x.pdu.size() != 5) return kIllegalValue;
  const std::size_t at = word(x.pdu, 1), value = word(x.pdu, 3);
  if (value != 0 && value != 0xFF00) return kIllegalValue;
  if (at >= kCoils) return kIllegalAddress;
  x.io.coils[at] = value != 0;
  x.echo(4);
  return 0;
}

std::uint8_t write_register(Exchange& x) noexcept {
  if (x.pdu.size() != 5) return kIllegalValue;
  const std::size_t at = word(x.pdu, 1);
  if (at >= kHoldingRegisters) return kIllegalAddress;
  x.io.holding_registers[at] = word(x.pdu, 3);
  x.echo(4);
  return 0;
}

std::uint8_t write_coils(Exchange& x) noexcept {
  if (x.pdu.size() < 7) return kIllegalValue;
  const std::size_t first = word(x.pdu, 1), count = word(x.pdu, 3), bytes = x.pdu[5];
  if (bytes != (count + 7) / 8 || x.pdu.size() != 6 + bytes) return kIllegalValue;
  if (const std::uint8_t wrong = check(first, count, kWriteBitsMax, kCoils)) return wrong;
  for (std::size_t i = 0; i < count; ++i) x.io.coils[first + i] = ((x.pdu[6 + i / 8] >> (i % 8)) & 1) != 0;
  x.echo(4);
  return 0;
}

std::uint8_t write_registers(Exchange& x) noexcept {
  if (x.pdu.size() < 8) return kIllegalValue;
  const std::size_t first = word(x.pdu, 1), count = word(x.pdu, 3), bytes = x.pdu[5];
  if (bytes != 2 * count || x.pdu.size() != 6 + bytes) return kIllegalValue;
  if (const std::uint8_t wrong = check(first, count, kWriteRegistersMax, kHoldingRegisters)) return wrong;
  for (std::size_t i = 0; i < count; ++i) x.io.holding_registers[first + i] = word(x.pdu, 6 + 2 * i);
  x.echo(4);
  return 0;
}

std::uint8_t mask_register(Exchange& x) noexcept {
  if (x.pdu.size() != 7) return kIllegalValue;
  const std::size_t at = word(x.pdu, 1);
  if (at >= kHoldingRegisters) return kIllegalAddress;
  const unsigned keep = word(x.pdu, 3), set = word(x.pdu, 5);
  std::uint16_t& value = x.io.holding_registers[at];
  value = static_cast<std::uint16_t>((value & keep) | (set & ~keep));
  x.echo(6);
  return 0;
}

std::uint8_t write_and_read_registers(Exchange& x) noexcept {
  if (x.pdu.size() < 12) return kIllegalValue;
  const std::size_t read_first = word(x.pdu, 1), read_count = word(x.pdu, 3);
  const std::size_t first = word(x.pdu, 5), count = word(x.pdu, 7), bytes = x.pdu[9];
  if (bytes != 2 * count || x.pdu.size() != 10 + bytes) return kIllegalValue;
  if (const std::uint8_t wrong = check(first, count, kReadWriteRegistersMax, kHoldingRegisters)) return wrong;
  if (const std::uint8_t wrong = check(read_first, read_count, kReadRegistersMax, kHoldingRegisters))
    return wrong;
  for (std::size_t i = 0; i < count; ++i) x.io.holding_registers[first + i] = word(x.pdu, 10 + 2 * i);
  put_registers(x, std::span<const std::uint16_t>(x.io.holding_registers).subspan(read_first, read_count));
  return 0;
}

std::uint8_t carry_out(Exchange& x) noexcept {
  switch (x.pdu[0]) {
    case 1: return read_bits(x, x.io.coils);
    case 2: return read_bits(x, x.io.discrete_inputs);
    case 3: return read_registers(x, x.io.holding_registers);
    case 4: return read_registers(x, x.io.input_registers);
    default: break;
  }
  x.wrote = true;
  switch (x.pdu[0]) {
    case 5: return write_coil(x);
    case 6: return write_register(x);
    case 15: return write_coils(x);
    case 16: return write_registers(x);
    case 22: return mask_register(x);
    case 23: return write_and_read_registers(x);
    default: return kIllegalFunction;
  }
}

std::uint8_t carry_out(Plant& plant, int unit, Bytes pdu, Reply& reply, std::size_t& length) noexcept {
  if (unit < 1 || unit > kUnits) return kGatewayTarget;
  Exchange x{plant.unit(unit), pdu, reply};
  const std::uint8_t wrong = carry_out(x);
  if (wrong == 0 && x.wrote) plant.note_write(unit);
  length = x.length;
  return wrong;
}

}  // namespace

Frame first_frame(Bytes received) noexcept {
  if (received.size() >= 4 && word(received, 2) != 0) return {FrameStatus::garbage, 0};
  if (received.size() < 6) return {};
  const std::size_t length = word(received, 4);
  if (length < kLengthMin || length > kLengthMax) return {FrameStatus::garbage, 0};
  if (received.size() < 6 + length) return {};
  return {FrameStatus::complete, 6 + length};
}

std::size_t answer(Plant& plant, Bytes frame, Reply& reply) noexcept {
  const Bytes pdu = frame.subspan(kHeader);
  std::size_t length = kHeader + 1;
  for (std::size_t i = 0; i <= kHeader; ++i) reply[i] = frame[i];
  if (const std::uint8_t wrong = carry_out(plant, frame[kHeader - 1], pdu, reply, length)) {
    reply[kHeader] = static_cast<std::uint8_t>(pdu[0] | 0x80);
    reply[kHeader + 1] = wrong;
    length = kHeader + 2;
  }
  reply[4] = static_cast<std::uint8_t>((length - 6) >> 8);
  reply[5] = static_cast<std::uint8_t>((length - 6) & 0xFF);
  return length;
}

}  // namespace stationd::plant

#include "io/modbus/adu.hpp"

#include <algorithm>

#include "io/modbus/plan.hpp"

namespace stationd::io::modbus {
namespace {

constexpr std::size_t kFunctionAt = kHeaderBytes, kReadDataAt = kHeaderBytes + 2,
                      kWriteDataAt = kHeaderBytes + 6;

void put_16(std::uint8_t* to, std::uint32_t value) noexcept {
  to[0] = static_cast<std::uint8_t>(value >> 8U);
  to[1] = static_cast<std::uint8_t>(value);
}

std::uint16_t get_16(const std::uint8_t* from) noexcept {
  return static_cast<std::uint16_t>((from[0] << 8U) | from[1]);
}

Adu make(Address to, std::uint8_t function, std::uint32_t a, std::uint32_t b,
         std::size_t more_bytes) noexcept {
  Adu adu;
  adu.size = kHeaderBytes + 5 + more_bytes;
  put_16(&adu.bytes[0], to.transaction);
  put_16(&adu.bytes[4], static_cast<std::uint32_t>(adu.size - 6));
  adu.bytes[6] = to.unit;
  adu.bytes[kFunctionAt] = function;
  put_16(&adu.bytes[kFunctionAt + 1], a);
  put_16(&adu.bytes[kFunctionAt + 3], b);
  return adu;
}

constexpr std::uint8_t read_function(Table table) noexcept {
  switch (table) {
    case Table::coil: return 1;
    case Table::discrete_input: return 2;
    case Table::holding_register: return 3;
    case Table::input_register: break;
  }
  return 4;
}

std::size_t data_bytes(bool bits, std::uint32_t count) noexcept {
  return bits ? (count + 7) / 8 : 2UL * count;
}

ExchangeResult broken(const char* detail) noexcept { return {ExchangeStatus::protocol, detail, 0}; }

ExchangeResult judge_body(const Adu& request, std::span<const std::uint8_t> reply) noexcept {
  const std::uint8_t function = request.function();
  if (function <= 4) {
    const std::size_t wanted = data_bytes(function <= 2, get_16(&request.bytes[kFunctionAt + 3]));
    if (reply.size() != kReadDataAt + wanted || reply[kFunctionAt + 1] != wanted)
      return broken("wrong number of values");
    return {};
  }
  if (reply.size() != kHeaderBytes + 5) return broken("wrong length of a confirmation");
  if (!std::equal(reply.begin() + kFunctionAt, reply.end(), request.bytes.begin() + kFunctionAt))
    return broken("confirms another write");
  return {};
}

std::int64_t limited(std::int64_t value, TagType type) noexcept {
  const IntegerRange range = integer_range(type);
  return std::clamp(value, range.min, range.max);
}

}  // namespace

Adu read_request(Address to, Table table, std::uint16_t first, std::uint32_t count) noexcept {
  return make(to, read_function(table), first, count, 0);
}

Adu write_request(Address to, Table table, std::uint16_t first, std::uint32_t count) noexcept {
  const std::size_t bytes = data_bytes(is_bits(table), count);
  Adu adu = make(to, is_bits(table) ? 15 : 16, first, count, 1 + bytes);
  adu.bytes[kWriteDataAt - 1] = static_cast<std::uint8_t>(bytes);
  return adu;
}

Adu write_register_request(Address to, std::uint16_t address, std::uint16_t value) noexcept {
  return make(to, 6, address, value, 0);
}

void put_bit(Adu& request, std::uint32_t offset, bool value) noexcept {
  std::uint8_t& byte = request.bytes[kWriteDataAt + offset / 8];
  const unsigned mask = 1U << (offset % 8);
  byte = static_cast<std::uint8_t>(value ? byte | mask : byte & ~mask);
}

void put_value(Adu& request, std::uint32_t offset, TagType type, Slot value) noexcept {
  const std::uint32_t width = width_of(Table::holding_register, type);
  for (std::uint32_t i = 0; i < width; ++i) {
    const std::uint32_t shift = 16U * (width - 1 - i);
    put_16(&request.bytes[kWriteDataAt + 2UL * (offset + i)], static_cast<std::uint16_t>(value >> shift));
  }
}

ExchangeResult judge(const Adu& request, std::span<const std::uint8_t> reply) noexcept {
  if (reply.size() < kHeaderBytes + 2) return broken("reply too short");
  if (get_16(&reply[0]) != get_16(&request.bytes[0])) return broken("reply to another request");
  if (get_16(&reply[2]) != 0) return broken("not the Modbus protocol");
  if (get_16(&reply[4]) != reply.size() - 6) return broken("wrong length");
  if (reply[6] != request.bytes[6]) return broken("reply of another unit");
  if (reply[kFunctionAt] == (request.function() | 0x80U)) {
    if (reply.size() != kHeaderBytes + 2) return broken("wrong length of an exception");
    return {ExchangeStatus::exception, "refused", reply[kFunctionAt + 1]};
  }
  if (reply[kFunctionAt] != request.function()) return broken("reply of another function");
  return judge_body(request, reply);
}

bool bit_at(std::span<const std::uint8_t> reply, std::uint32_t offset) noexcept {
  const unsigned byte = reply[kReadDataAt + offset / 8];
  return ((byte >> (offset % 8)) & 1U) != 0;
}

Slot value_at(std::span<const std::uint8_t> reply, std::uint32_t offset, TagType type) noexcept {
  const std::uint8_t* at = &reply[kReadDataAt + 2UL * offset];
  const std::uint32_t width = width_of(Table::holding_register, type);
  std::uint64_t raw = 0;
  for (std::uint32_t i = 0; i < width; ++i) raw = (raw << 16U) | get_16(at + 2UL * i);
  switch (type) {
    case TagType::BOOL: return raw != 0 ? 1 : 0;
    case TagType::SINT: return to_slot(limited(static_cast<std::int16_t>(raw), type));
    case TagType::USINT: return to_slot(limited(static_cast<std::int64_t>(raw), type));
    case TagType::INT: return to_slot(static_cast<std::int16_t>(raw));
    case TagType::DINT: return to_slot(static_cast<std::int32_t>(raw));
    default: return raw;
  }
}

}  // namespace stationd::io::modbus

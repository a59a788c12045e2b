// Requests as bytes; replies judged and decoded.
#include <algorithm>
#include <random>

#include <doctest/doctest.h>

#include "io/modbus/adu.hpp"

namespace stationd::io::modbus {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const Adu& adu) {
  return Bytes(adu.bytes.begin(), adu.bytes.begin() + static_cast<long>(adu.size));
}

/// A reply to transaction 0x0102 of unit 3 with this PDU.
Bytes reply(const Bytes& pdu) {
  Bytes out(kHeaderBytes + pdu.size());
  out[0] = 1;
  out[1] = 2;
  out[5] = static_cast<std::uint8_t>(pdu.size() + 1);
  out[6] = 3;
  std::copy(pdu.begin(), pdu.end(), out.begin() + kHeaderBytes);
  return out;
}

constexpr Address kTo{0x0102, 3};

ExchangeStatus status_of(const Adu& request, const Bytes& bytes) { return judge(request, bytes).status; }

Slot round_trip(TagType type, Slot value) {
  Adu request = write_request(kTo, Table::holding_register, 0, 4);
  put_value(request, 0, type, value);
  Bytes pdu(request.bytes.begin() + 12, request.bytes.begin() + 21);
  pdu.insert(pdu.begin(), 3);
  return value_at(reply(pdu), 0, type);
}

}  // namespace

TEST_CASE("requests are encoded as the protocol has them [IO-1]") {
  CHECK(bytes_of(read_request(kTo, Table::discrete_input, 0x10, 20)) ==
        Bytes{1, 2, 0, 0, 0, 6, 3, 2, 0, 0x10, 0, 20});
  CHECK(read_request(kTo, Table::coil, 0, 1).function() == 1);
  CHECK(read_request(kTo, Table::holding_register, 0, 1).function() == 3);
  CHECK(read_request(kTo, Table::input_register, 0, 1).function() == 4);
  CHECK(bytes_of(write_register_request(kTo, 1, 0xABCD)) == Bytes{1, 2, 0, 0, 0, 6, 3, 6, 0, 1, 0xAB, 0xCD});
  Adu coils = write_request(kTo, Table::coil, 2, 9);
  put_bit(coils, 0, true);
  put_bit(coils, 8, true);
  CHECK(bytes_of(coils) == Bytes{1, 2, 0, 0, 0, 9, 3, 15, 0, 2, 0, 9, 2, 1, 1});
  Adu registers = write_request(kTo, Table::holding_register, 2, 2);
  put_value(registers, 0, TagType::UDINT, 0x01020304);
  CHECK(bytes_of(registers) == Bytes{1, 2, 0, 0, 0, 11, 3, 16, 0, 2, 0, 2, 4, 1, 2, 3, 4});
}

TEST_CASE("every type comes back as it was written, high word first [IO-1]") {
  CHECK(from_slot<std::int8_t>(round_trip(TagType::SINT, to_slot(std::int8_t{-5}))) == -5);
  CHECK(from_slot<std::int16_t>(round_trip(TagType::INT, to_slot(std::int16_t{-500}))) == -500);
  CHECK(round_trip(TagType::INT, to_slot(std::int16_t{-500})) == to_slot(std::int16_t{-500}));
  CHECK(round_trip(TagType::DINT, to_slot(std::int32_t{-70'000})) == to_slot(std::int32_t{-70'000}));
  CHECK(round_trip(TagType::UDINT, 0xFFFFFFFF) == 0xFFFFFFFF);
  CHECK(round_trip(TagType::LINT, to_slot(std::int64_t{-1})) == to_slot(std::int64_t{-1}));
  CHECK(from_slot<float>(round_trip(TagType::REAL, to_slot(1.5F))) == 1.5F);
  CHECK(from_slot<double>(round_trip(TagType::LREAL, to_slot(-2.25))) == -2.25);
  CHECK(from_slot<Time>(round_trip(TagType::TIME, to_slot(Time{123'456'789'012}))).ns == 123'456'789'012);
}

TEST_CASE("8-bit value out of its range is limited, not cut [IO-1]") {
  const Bytes high = reply({3, 2, 0x01, 0x00});
  CHECK(value_at(high, 0, TagType::USINT) == 255);
  CHECK(from_slot<std::int8_t>(value_at(high, 0, TagType::SINT)) == 127);
  CHECK(from_slot<std::int8_t>(value_at(reply({3, 2, 0x80, 0x00}), 0, TagType::SINT)) == -128);
}

TEST_CASE("bits come in the protocol's order [IO-1]") {
  const Bytes bits = reply({2, 2, 0b00000101, 0b00000010});
  CHECK(bit_at(bits, 0));
  CHECK(!bit_at(bits, 1));
  CHECK(bit_at(bits, 2));
  CHECK(!bit_at(bits, 8));
  CHECK(bit_at(bits, 9));
}

TEST_CASE("reply that fits its request is ok [IO-3]") {
  CHECK(status_of(read_request(kTo, Table::coil, 0, 9), reply({1, 2, 0, 0})) == ExchangeStatus::ok);
  CHECK(status_of(read_request(kTo, Table::input_register, 0, 2), reply({4, 4, 0, 0, 0, 0})) ==
        ExchangeStatus::ok);
  CHECK(status_of(write_request(kTo, Table::coil, 2, 9), reply({15, 0, 2, 0, 9})) == ExchangeStatus::ok);
  CHECK(status_of(write_register_request(kTo, 1, 7), reply({6, 0, 1, 0, 7})) == ExchangeStatus::ok);
}

TEST_CASE("reply that differs in any field is refused [IO-3]") {
  const Adu read = read_request(kTo, Table::input_register, 0, 1);
  const Bytes good = reply({4, 2, 0x12, 0x34});
  REQUIRE(status_of(read, good) == ExchangeStatus::ok);
  for (std::size_t i = 0; i < 9; ++i) {
    Bytes bad = good;
    bad[i] ^= 1;
    CHECK_MESSAGE(status_of(read, bad) == ExchangeStatus::protocol, i);
  }
  for (std::size_t size = 0; size < good.size(); ++size)
    CHECK_MESSAGE(status_of(read, Bytes(good.begin(), good.begin() + static_cast<long>(size))) ==
                      ExchangeStatus::protocol,
                  size);
  const Adu write = write_request(kTo, Table::coil, 2, 9);
  CHECK(status_of(write, reply({15, 0, 2, 0, 8})) == ExchangeStatus::protocol);
  CHECK(status_of(write, reply({15, 0, 2, 0, 9, 0})) == ExchangeStatus::protocol);
}

TEST_CASE("reply of another unit is refused [IO-3]") {
  Bytes other = reply({4, 2, 0, 0});
  other[6] = 4;
  const ExchangeResult result = judge(read_request(kTo, Table::input_register, 0, 1), other);
  CHECK(result.status == ExchangeStatus::protocol);
  CHECK(std::string(result.detail) == "reply of another unit");
}

TEST_CASE("exception is told apart with its code [IO-3]") {
  const ExchangeResult result = judge(read_request(kTo, Table::input_register, 0, 1), reply({0x84, 2}));
  CHECK(result.status == ExchangeStatus::exception);
  CHECK(result.code == 2);
}

TEST_CASE("random reply never passes for a good one nor reads beyond its end [IO-3]") {
  std::mt19937 random(1);
  const Adu read = read_request(kTo, Table::input_register, 0, 3);
  const Bytes good = reply({4, 6, 0, 1, 0, 2, 0, 3});
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes = good;
    bytes.resize(random() % 24);
    for (int changes = static_cast<int>(random() % 3); changes > 0 && !bytes.empty(); --changes)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    const bool ok = judge(read, bytes).status == ExchangeStatus::ok;
    const bool fits =
        bytes.size() == good.size() && std::equal(bytes.begin(), bytes.begin() + 9, good.begin());
    REQUIRE(ok == fits);
  }
}

}  // namespace stationd::io::modbus

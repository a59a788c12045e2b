// Plan: which Modbus requests read and write the points of one device.
// Owned by the device's backend; made once at set-up.
// Pure functions; the device thread.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/backend.hpp"
#include "io/options.hpp"

namespace stationd::io::modbus {

/// The protocol's limits on one request.
inline constexpr std::uint32_t kMaxReadRegisters = 125, kMaxReadBits = 2000;
inline constexpr std::uint32_t kMaxWriteRegisters = 123, kMaxWriteBits = 1968;
/// Places that nobody asked for and that are read all the same, to save a request.
inline constexpr std::uint32_t kReadGapRegisters = 8, kReadGapBits = 64;

/// A point's place in a request's data.
struct Item {
  std::uint32_t point = 0;   ///< its number among the device's inputs (outputs)
  std::uint32_t offset = 0;  ///< registers or bits from the request's first
  std::uint32_t width = 1;
  TagType type = TagType::BOOL;
};

struct Request {
  Table table = Table::coil;
  std::uint16_t first = 0;
  std::uint32_t count = 0;  ///< registers or bits
  std::vector<Item> items;  ///< by offset
  std::string label;        ///< "read di 0..19"
};

/// The reads that bring all input points: neighbours and near neighbours of one table in one request, within
/// the protocol's limits; no value spans two requests.
std::vector<Request> plan_reads(const std::vector<Point>& points);

/// The writes of all output points: neighbours in one request, no gaps: only what is mapped is written.
std::vector<Request> plan_writes(const std::vector<Point>& points);

/// A stretch of a planned write that is written now: items [begin, end).
struct Stretch {
  std::size_t begin = 0, end = 0;
};

/// The next stretch of `request` from item `from` on that leaves out all outputs with write == false.
/// begin == end: there is none.
Stretch next_stretch(const Request& request, std::size_t from, std::span<const OutputValue> outputs) noexcept;

}  // namespace stationd::io::modbus

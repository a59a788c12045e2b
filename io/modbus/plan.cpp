#include "io/modbus/plan.hpp"

#include <algorithm>
#include <tuple>

namespace stationd::io::modbus {
namespace {

struct Place {
  Table table;
  std::uint32_t address, width, point;
  TagType type;
};

std::string_view short_name(Table table) noexcept {
  switch (table) {
    case Table::coil: return "co";
    case Table::discrete_input: return "di";
    case Table::holding_register: return "hr";
    case Table::input_register: break;
  }
  return "ir";
}

/// The points of one direction in the order of their addresses; numbered as the backend's user numbers them.
std::vector<Place> places_of(const std::vector<Point>& points, Direction direction) {
  std::vector<Place> places;
  std::uint32_t number = 0;
  for (const Point& point : points) {
    if (point.direction != direction) continue;
    places.push_back({point.table, point.address, width_of(point.table, point.type), number++, point.type});
  }
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::tie(a.table, a.address, a.width, a.point) < std::tie(b.table, b.address, b.width, b.point);
  });
  return places;
}

struct Limits {
  std::uint32_t registers, bits, gap_registers, gap_bits;
};

std::vector<Request> plan(const std::vector<Point>& points, Direction direction, const Limits& limits) {
  std::vector<Request> requests;
  for (const Place& place : places_of(points, direction)) {
    const std::uint32_t most = is_bits(place.table) ? limits.bits : limits.registers;
    const std::uint32_t gap = is_bits(place.table) ? limits.gap_bits : limits.gap_registers;
    Request* last = requests.empty() ? nullptr : &requests.back();
    const bool joins = last != nullptr && last->table == place.table &&
                       place.address <= last->first + last->count + gap &&
                       place.address + place.width - last->first <= most;
    if (!joins) {
      requests.push_back({place.table, static_cast<std::uint16_t>(place.address), 0, {}, {}});
      last = &requests.back();
    }
    const std::uint32_t offset = place.address - last->first;
    last->items.push_back({place.point, offset, place.width, place.type});
    last->count = std::max(last->count, offset + place.width);
  }
  for (Request& request : requests)
    request.label = std::string(direction == Direction::input ? "read " : "write ") +
                    std::string(short_name(request.table)) + " " + std::to_string(request.first) + ".." +
                    std::to_string(request.first + request.count - 1);
  return requests;
}

}  // namespace

std::vector<Request> plan_reads(const std::vector<Point>& points) {
  return plan(points, Direction::input, {kMaxReadRegisters, kMaxReadBits, kReadGapRegisters, kReadGapBits});
}

std::vector<Request> plan_writes(const std::vector<Point>& points) {
  return plan(points, Direction::output, {kMaxWriteRegisters, kMaxWriteBits, 0, 0});
}

Stretch next_stretch(const Request& request, std::size_t from,
                     std::span<const OutputValue> outputs) noexcept {
  const auto written = [&](std::size_t item) { return outputs[request.items[item].point].write; };
  while (from < request.items.size() && !written(from)) ++from;
  std::size_t end = from;
  while (end < request.items.size() && written(end)) ++end;
  return {from, end};
}

}  // namespace stationd::io::modbus

// Which requests a device's points become; when a failing device is tried again.
#include <doctest/doctest.h>

#include "io/modbus/backoff.hpp"
#include "io/modbus/plan.hpp"

namespace stationd::io::modbus {
namespace {

Point at(Table table, int address, TagType type = TagType::BOOL, Direction direction = Direction::input) {
  Point point;
  point.table = table;
  point.address = static_cast<std::uint16_t>(address);
  point.type = type;
  point.direction = direction;
  return point;
}

std::vector<std::string> labels(const std::vector<Request>& requests) {
  std::vector<std::string> out;
  for (const Request& request : requests) out.push_back(request.label);
  return out;
}

using Labels = std::vector<std::string>;

}  // namespace

TEST_CASE("a station's inputs take one read per table [IO-2]") {
  std::vector<Point> points;
  for (int i = 0; i < 20; ++i) points.push_back(at(Table::discrete_input, i));
  points.push_back(at(Table::input_register, 0, TagType::UDINT));
  for (int i = 2; i < 7; ++i) points.push_back(at(Table::input_register, i, TagType::UINT));
  const auto reads = plan_reads(points);
  CHECK(labels(reads) == Labels{"read di 0..19", "read ir 0..6"});
  CHECK(reads[1].items[0].width == 2);
  CHECK(reads[1].items[5].point == 25);
  CHECK(reads[1].items[5].offset == 6);
}

TEST_CASE("small gap is bridged when reading, a large one not [IO-2]") {
  const auto u = TagType::UINT;
  CHECK(labels(plan_reads({at(Table::holding_register, 0, u), at(Table::holding_register, 9, u)})) ==
        Labels{"read hr 0..9"});
  CHECK(labels(plan_reads({at(Table::holding_register, 0, u), at(Table::holding_register, 10, u)})).size() ==
        2);
  CHECK(labels(plan_reads({at(Table::coil, 0), at(Table::coil, 65)})).size() == 1);
  CHECK(labels(plan_reads({at(Table::coil, 0), at(Table::coil, 66)})).size() == 2);
}

TEST_CASE("read never exceeds the protocol's limit, and no value spans two requests [IO-2]") {
  std::vector<Point> points;
  for (int i = 0; i < 200; ++i) points.push_back(at(Table::input_register, 3 * i, TagType::UDINT));
  std::size_t items = 0;
  for (const Request& read : plan_reads(points)) {
    CHECK(read.count <= kMaxReadRegisters);
    for (const Item& item : read.items) CHECK(item.offset + item.width <= read.count);
    items += read.items.size();
  }
  CHECK(items == 200);
}

TEST_CASE("two points on one place share its request [IO-2]") {
  const auto reads = plan_reads({at(Table::coil, 5), at(Table::coil, 5), at(Table::coil, 4)});
  REQUIRE(reads.size() == 1);
  CHECK(reads[0].count == 2);
  CHECK(reads[0].items.size() == 3);
}

TEST_CASE("write never bridges a gap [IO-2]") {
  const auto out = Direction::output;
  const auto writes =
      plan_writes({at(Table::coil, 0, TagType::BOOL, out), at(Table::coil, 1, TagType::BOOL, out),
                   at(Table::coil, 3, TagType::BOOL, out), at(Table::coil, 9)});
  CHECK(labels(writes) == Labels{"write co 0..1", "write co 3..3"});
}

TEST_CASE("write of many registers is cut between values at the protocol's limit [IO-2]") {
  std::vector<Point> points;
  for (int i = 0; i < 40; ++i)
    points.push_back(at(Table::holding_register, 4 * i, TagType::LREAL, Direction::output));
  const auto writes = plan_writes(points);
  REQUIRE(writes.size() == 2);
  CHECK(writes[0].count == 120);
  CHECK(writes[1].first == 120);
}

TEST_CASE("held output splits its write around it [IO-6]") {
  std::vector<Point> points;
  for (int i = 0; i < 5; ++i) points.push_back(at(Table::coil, i, TagType::BOOL, Direction::output));
  const auto writes = plan_writes(points);
  std::vector<OutputValue> outputs(5);
  outputs[0].write = false;
  outputs[3].write = false;
  const Stretch first = next_stretch(writes[0], 0, outputs);
  CHECK(first.begin == 1);
  CHECK(first.end == 3);
  const Stretch second = next_stretch(writes[0], first.end, outputs);
  CHECK(second.begin == 4);
  CHECK(second.end == 5);
  const Stretch none = next_stretch(writes[0], second.end, outputs);
  CHECK(none.begin == none.end);
}

TEST_CASE("back-off doubles from 0.1 s to 5 s within a quarter and starts anew after success [IO-3]") {
  Backoff backoff(7);
  CHECK(backoff.may_try(0));
  std::int64_t wait_ns = Backoff::kFirstNs;
  for (int i = 0; i < 20; ++i) {
    backoff.failed(0);
    CHECK(!backoff.may_try(wait_ns * 3 / 4 - 1));
    CHECK(backoff.may_try(wait_ns * 5 / 4));
    wait_ns = std::min(2 * wait_ns, Backoff::kMostNs);
  }
  backoff.succeeded();
  backoff.failed(0);
  CHECK(backoff.may_try(Backoff::kFirstNs * 5 / 4));
}

}  // namespace stationd::io::modbus

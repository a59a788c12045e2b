// The numbers that Starts and Stops get: in the order of receipt, also where a flood is taken in batches.
#include <doctest/doctest.h>

#include <vector>

#include "dds_bridge/order_numbers.hpp"

namespace stationd::bus::test {
namespace {

std::vector<ReceivedOrder> received(const std::vector<std::int64_t>& times) {
  std::vector<ReceivedOrder> orders(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) orders[i].received = times[i];
  return orders;
}

std::vector<std::uint64_t> numbers(const std::vector<ReceivedOrder>& orders) {
  std::vector<std::uint64_t> all;
  for (const ReceivedOrder& order : orders) all.push_back(order.origin.order);
  return all;
}

using Numbers = std::vector<std::uint64_t>;

TEST_CASE("order_numbers when Starts and Stops are taken together then follow the times of receipt [REQ-2]") {
  OrderNumbers order;
  auto stops = received({20, 40});
  auto starts = received({10, 30, 50});
  order.number(stops, starts, false);
  CHECK(numbers(starts) == Numbers{1, 3, 5});
  CHECK(numbers(stops) == Numbers{2, 4});
}

TEST_CASE("order_numbers when both are received at one time then the Stop is the later [REQ-2]") {
  OrderNumbers order;
  auto stops = received({10});
  auto starts = received({10});
  order.number(stops, starts, false);
  CHECK(starts[0].origin.order < stops[0].origin.order);
}

TEST_CASE("order_numbers when one station's orders come before another's then are sorted [REQ-2]") {
  OrderNumbers order;
  auto stops = received({40, 20});
  auto starts = received({30, 10});
  order.number(stops, starts, false);
  CHECK(numbers(starts) == Numbers{1, 3});
  CHECK(numbers(stops) == Numbers{2, 4});
}

TEST_CASE("order_numbers when a Start is left for a later batch then stays below the Stop after it [REQ-2]") {
  OrderNumbers order;
  auto none = received({});
  auto first = received({1});
  order.number(none, first, false);  // 1
  auto stops = received({50});
  auto starts = received({10, 20});
  order.number(stops, starts, true);
  CHECK(numbers(stops) == Numbers{4});
  auto middle = received({30, 40});
  order.number(none, middle, true);
  auto last = received({45, 60});
  order.number(none, last, false);
  CHECK(numbers(middle) == Numbers{1, 1});
  CHECK(numbers(last) == Numbers{1, 5});
}

TEST_CASE("order_numbers when the backlog is gone then a clock that was set back harms no Start [REQ-2]") {
  OrderNumbers order;
  auto stops = received({1'000});
  auto none = received({});
  order.number(stops, none, false);
  auto starts = received({5});
  order.number(none, starts, false);
  CHECK(starts[0].origin.order > stops[0].origin.order);
}

}  // namespace
}  // namespace stationd::bus::test

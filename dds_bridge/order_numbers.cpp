#include "dds_bridge/order_numbers.hpp"

#include <algorithm>

namespace stationd::bus {

void OrderNumbers::number(std::vector<ReceivedOrder>& stops, std::vector<ReceivedOrder>& starts,
                          bool starts_cut) {
  if (!cut_) {
    late_number_ = last_;
    last_stop_ = INT64_MIN;
  }
  // DDS hands out one station's orders after another's.
  std::ranges::stable_sort(stops, {}, &ReceivedOrder::received);
  std::ranges::stable_sort(starts, {}, &ReceivedOrder::received);
  auto start = starts.begin();
  for (; start != starts.end() && start->received <= last_stop_; ++start) start->origin.order = late_number_;
  for (ReceivedOrder& stop : stops) {
    while (start != starts.end() && start->received <= stop.received) (start++)->origin.order = ++last_;
    stop.origin.order = ++last_;
    last_stop_ = std::max(last_stop_, stop.received);
  }
  while (start != starts.end()) (start++)->origin.order = ++last_;
  cut_ = starts_cut;
}

}  // namespace stationd::bus

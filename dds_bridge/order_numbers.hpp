// OrderNumbers: numbers Starts and Stops in the order in which they were received, over batches of bounded
// size.
// Private to dds_bridge; owned by the readers.
// Pure: times come in as values. The bus-in thread, or a test.
#pragma once

#include <cstdint>
#include <vector>

#include "dds_bridge/bus.hpp"

namespace stationd::bus {

struct ReceivedOrder {
  MsgReq message;
  Origin origin;
  std::int64_t received = 0;  // by the library's clock
};

class OrderNumbers {
 public:
  /// Puts both lists of a batch into the order of receipt and sets `origin.order`. At equal times the Stop
  /// counts as the later, so that it wins. `starts_cut`: more Starts may have been waiting than the batch
  /// has. One that comes in a later batch, although it was received before a Stop of this one, gets a number
  /// below that Stop's.
  void number(std::vector<ReceivedOrder>& stops, std::vector<ReceivedOrder>& starts, bool starts_cut);

 private:
  std::uint64_t last_ = 0;
  bool cut_ = false;                    // the batch before this one was
  std::uint64_t late_number_ = 0;       // below each Stop since the batches were cut
  std::int64_t last_stop_ = INT64_MIN;  // receipt of the last Stop since then
};

}  // namespace stationd::bus

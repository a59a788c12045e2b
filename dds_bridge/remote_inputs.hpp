// RemoteInputs: Set, End and Status of other stations into the bus links of ours.
// Private to dds_bridge; owned by the bridge.
// Set-up by one thread, then the bus-in thread (the links' one producer).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dds_bridge/bridge_context.hpp"
#include "dds_bridge/cell_types.hpp"
#include "dds_bridge/field_map.hpp"

namespace stationd::bus {

class RemoteInputs {
 public:
  /// Takes in the bus links of a station. Throws BusError for a topic, member or type that does not fit.
  void add(Station& station);

  bool wants(TopicId topic) const noexcept;
  /// Names of the stations whose samples are wanted.
  std::vector<std::string> stations() const;
  /// A sample of that topic: all its links get it, as one block each.
  void put(TopicId topic, const std::string& station, const void* object, std::int64_t receipt_ns);

 private:
  struct Link {
    InputLink* link;
    TopicId topic;
    std::string station;
    std::vector<FieldMap> maps;
    std::uint64_t count = 0;
  };
  std::vector<Link> links_;
};

}  // namespace stationd::bus

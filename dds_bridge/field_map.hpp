// FieldMap: carries values between a link's slots and the members of a topic's struct, by the member table.
// Owned by the bridge, one list per link; made at set-up.
// The bus-out thread (store) or the bus-in thread (load).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dds_bridge/type_table.hpp"
#include "scan/image.hpp"
#include "scan/links.hpp"

namespace stationd::bus {

struct FieldMap {
  const Member* member;
  std::uint32_t slot;    ///< first slot in the link's blocks
  std::uint32_t length;  ///< STRING: most bytes
};

/// Set-up. `into_tags`: members become tags, else tags become members. Throws BusError, naming `link`, for an
/// unknown member, or a tag whose type cannot hold all values of the other side.
std::vector<FieldMap> map_fields(const TypeTable& table, const std::vector<std::string>& members,
                                 const LinkTags& tags, const Image& image, bool into_tags,
                                 const std::string& link);

/// Slots into the struct.
void store(const FieldMap& map, const Slot* slots, void* object);
/// The struct into slots.
void load(const FieldMap& map, const void* object, Slot* slots);

}  // namespace stationd::bus

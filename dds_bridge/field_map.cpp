#include "dds_bridge/field_map.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "dds_bridge/body.hpp"
#include "dds_bridge/bus.hpp"

namespace stationd::bus {
namespace {

/// The tag type that holds exactly what the member holds.
TagType tag_type(Kind kind) {
  static constexpr std::array<TagType, 13> types = {
      TagType::BOOL,  TagType::SINT,   TagType::USINT, TagType::INT,   TagType::UINT,
      TagType::DINT,  TagType::UDINT,  TagType::LINT,  TagType::ULINT, TagType::REAL,
      TagType::LREAL, TagType::STRING, TagType::UDINT};
  return types[static_cast<std::size_t>(kind)];
}

bool is_integer(TagType type) {
  return type != TagType::BOOL && type != TagType::REAL && type != TagType::LREAL &&
         type != TagType::STRING && type != TagType::ULINT;
}

/// Whether every value of `from` is one of `to`.
bool fits(TagType from, TagType to) {
  if (from == to) return true;
  if (from == TagType::REAL && to == TagType::LREAL) return false;  // another bit pattern in the slot
  if (!is_integer(from) || !is_integer(to)) return false;
  const IntegerRange narrow = integer_range(from), wide = integer_range(to);
  return wide.min <= narrow.min && narrow.max <= wide.max;
}

template <class T> void put(const FieldMap& map, Slot slot, void* object) {
  const T value = from_slot<T>(slot);
  std::memcpy(static_cast<char*>(object) + map.member->offset, &value, sizeof(T));
}

template <class T> Slot get(const FieldMap& map, const void* object) {
  T value{};
  std::memcpy(&value, static_cast<const char*>(object) + map.member->offset, sizeof(T));
  return to_slot(value);
}

}  // namespace

std::vector<FieldMap> map_fields(const TypeTable& table, const std::vector<std::string>& members,
                                 const LinkTags& tags, const Image& image, bool into_tags,
                                 const std::string& link) {
  std::vector<FieldMap> maps;
  std::uint32_t slot = 0;
  for (std::size_t i = 0; i < tags.tags.size(); ++i) {
    const TagSpec& spec = image.spec(tags.tags[i]);
    const Member* member = i < members.size() ? table.find(members[i]) : nullptr;
    if (member == nullptr) {
      throw BusError(link + ": " + std::string(table.name) + " has no member " +
                     (i < members.size() ? members[i] : "for tag " + spec.name));
    }
    const TagType type = tag_type(member->kind);
    if (into_tags ? !fits(type, spec.type) : !fits(spec.type, type)) {
      throw BusError(link + ": member " + members[i] + " is " + std::string(name_of(type)) + ", tag " +
                     spec.name + " is " + std::string(name_of(spec.type)));
    }
    maps.push_back({member, slot, spec.length});
    slot += image.slot_count(tags.tags[i]);
  }
  return maps;
}

void store(const FieldMap& map, const Slot* slots, void* object) {
  const Slot slot = slots[map.slot];
  switch (map.member->kind) {
    case Kind::boolean: put<bool>(map, slot, object); return;
    case Kind::int8: put<std::int8_t>(map, slot, object); return;
    case Kind::uint8: put<std::uint8_t>(map, slot, object); return;
    case Kind::int16: put<std::int16_t>(map, slot, object); return;
    case Kind::uint16: put<std::uint16_t>(map, slot, object); return;
    case Kind::int32: put<std::int32_t>(map, slot, object); return;
    case Kind::enumeration:
    case Kind::uint32: put<std::uint32_t>(map, slot, object); return;
    case Kind::int64: put<std::int64_t>(map, slot, object); return;
    case Kind::uint64: put<std::uint64_t>(map, slot, object); return;
    case Kind::float32: put<float>(map, slot, object); return;
    case Kind::float64: put<double>(map, slot, object); return;
    case Kind::text: {  // the first slot is the length, the bytes follow
      auto& text = *reinterpret_cast<std::string*>(static_cast<char*>(object) + map.member->offset);
      const auto length = std::min<std::size_t>({slot, map.length, map.member->bound});
      text.assign(reinterpret_cast<const char*>(slots + map.slot + 1), length);
      return;
    }
  }
}

void load(const FieldMap& map, const void* object, Slot* slots) {
  Slot& slot = slots[map.slot];
  switch (map.member->kind) {
    case Kind::boolean: slot = get<bool>(map, object); return;
    case Kind::int8: slot = get<std::int8_t>(map, object); return;
    case Kind::uint8: slot = get<std::uint8_t>(map, object); return;
    case Kind::int16: slot = get<std::int16_t>(map, object); return;
    case Kind::uint16: slot = get<std::uint16_t>(map, object); return;
    case Kind::int32: slot = get<std::int32_t>(map, object); return;
    case Kind::enumeration:
    case Kind::uint32: slot = get<std::uint32_t>(map, object); return;
    case Kind::int64: slot = get<std::int64_t>(map, object); return;
    case Kind::uint64: slot = get<std::uint64_t>(map, object); return;
    case Kind::float32: slot = get<float>(map, object); return;
    case Kind::float64: slot = get<double>(map, object); return;
    case Kind::text: {
      const auto& text =
          *reinterpret_cast<const std::string*>(static_cast<const char*>(object) + map.member->offset);
      const std::string cut = clipped(text, map.length);
      std::memset(slots + map.slot + 1, 0, (map.length + sizeof(Slot) - 1) / sizeof(Slot) * sizeof(Slot));
      std::memcpy(slots + map.slot + 1, cut.data(), cut.size());
      slot = cut.size();
      return;
    }
  }
}

}  // namespace stationd::bus

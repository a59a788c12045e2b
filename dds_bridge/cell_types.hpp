// Cell types: the member tables of the cell's own messages, and the cell's topics with their class of
// service.
// Private to dds_bridge; constant data.
// Any thread.
#pragma once

#include <span>
#include <string_view>

#include "dds_bridge/messages.hpp"
#include "dds_bridge/type_table.hpp"

namespace stationd::bus {

/// The paper's services (Table 1), with its QoS in Table 2; and `diagnostic`: the runtime's own PVs, of the
/// lowest priority and without a Deadline: nobody acts on them.
enum class Service : std::uint8_t { pv, ase, rnr, rr, diagnostic };

enum class TopicId : std::uint8_t { set, end, status, gse, start, stop, request, reply, stats };
inline constexpr std::size_t kTopics = 9;

struct TopicInfo {
  TopicId id;
  std::string_view name;
  const TypeTable* type;
  Service service;
  std::string_view filter_member;  ///< which readers can be content filtered by
};

/// All topics, in the order of TopicId.
std::span<const TopicInfo> topics() noexcept;
const TopicInfo& topic(TopicId id) noexcept;
/// Null: the cell has no such topic.
const TopicInfo* find_topic(std::string_view name) noexcept;

template <class T> const TypeTable& table_of() noexcept;
template <> const TypeTable& table_of<Set>() noexcept;
template <> const TypeTable& table_of<End>() noexcept;
template <> const TypeTable& table_of<Status>() noexcept;
template <> const TypeTable& table_of<Gse>() noexcept;
template <> const TypeTable& table_of<MsgReq>() noexcept;
template <> const TypeTable& table_of<MsgRes>() noexcept;
template <> const TypeTable& table_of<ScanStats>() noexcept;

/// Longest texts in bytes: keys and names, free text, bodies on the wire (the configuration's limit is
/// lower).
inline constexpr std::uint32_t kNameBound = 255;
inline constexpr std::uint32_t kTextBound = 1024;
inline constexpr std::uint32_t kBodyBound = 65'536;

}  // namespace stationd::bus

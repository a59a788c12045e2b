#include "dds_bridge/cell_types.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

#include "dds_bridge/bus.hpp"

namespace stationd::bus {
namespace {

template <class T>
TypeTable table(std::string_view name, std::span<const Member> members, std::span<const std::size_t> released,
                std::size_t paper_members) {
  static_assert(std::is_standard_layout_v<T>, "offsetof needs it");
  return {name,
          members,
          released,
          paper_members,
          []() -> void* { return new T; },
          [](void* object) { delete static_cast<T*>(object); },
          [](void* object) { *static_cast<T*>(object) = T{}; }};
}

constexpr Member key(std::string_view name, std::size_t offset) {
  return {.name = name, .kind = Kind::text, .offset = offset, .key = true, .bound = kNameBound};
}
constexpr Member text(std::string_view name, std::size_t offset, std::uint32_t bound = kTextBound) {
  return {.name = name, .kind = Kind::text, .offset = offset, .bound = bound};
}
constexpr Member number(std::string_view name, Kind kind, std::size_t offset) {
  return {.name = name, .kind = kind, .offset = offset};
}

constexpr std::array set_members = {
    key("STATION", offsetof(Set, STATION)),
    number("CODE", Kind::uint32, offsetof(Set, CODE)),
    number("ERROR", Kind::boolean, offsetof(Set, ERROR)),
    number("STATUS", Kind::uint32, offsetof(Set, STATUS)),
    number("EPOCH", Kind::uint32, offsetof(Set, EPOCH)),
    number("SEQ", Kind::uint32, offsetof(Set, SEQ)),
};
constexpr std::array<std::size_t, 2> set_released = {2, set_members.size()};

constexpr std::array end_members = {
    key("STATION", offsetof(End, STATION)),
    number("CODE", Kind::uint32, offsetof(End, CODE)),
    number("ERROR", Kind::boolean, offsetof(End, ERROR)),
    number("STATUS", Kind::uint32, offsetof(End, STATUS)),
    number("EPOCH", Kind::uint32, offsetof(End, EPOCH)),
    number("SEQ", Kind::uint32, offsetof(End, SEQ)),
};
constexpr std::array<std::size_t, 2> end_released = {4, end_members.size()};

constexpr std::array gse_members = {
    number("ERROR", Kind::boolean, offsetof(Gse, ERROR)),
    number("STATUS", Kind::uint32, offsetof(Gse, STATUS)),
    text("STATION", offsetof(Gse, STATION), kNameBound),
    number("EPOCH", Kind::uint32, offsetof(Gse, EPOCH)),
    number("SEQ", Kind::uint32, offsetof(Gse, SEQ)),
    number("SEVERITY", Kind::uint32, offsetof(Gse, SEVERITY)),
    number("ACTIVE", Kind::boolean, offsetof(Gse, ACTIVE)),
    number("EDGE", Kind::boolean, offsetof(Gse, EDGE)),
    number("SOURCE_TIME", Kind::int64, offsetof(Gse, SOURCE_TIME)),
    number("DETAIL", Kind::int64, offsetof(Gse, DETAIL)),
    text("TEXT", offsetof(Gse, TEXT)),
};
constexpr std::array<std::size_t, 2> gse_released = {2, gse_members.size()};

constexpr std::array<std::string_view, 3> orders = {"START", "STOP", "MSG"};
// A BODY that is not UTF-8 is refused with an answer, so it has to get through here.
constexpr std::array request_members = {
    key("DEST_STATION", offsetof(MsgReq, DEST_STATION)),
    Member{.name = "BODY",
           .kind = Kind::text,
           .offset = offsetof(MsgReq, BODY),
           .bound = kBodyBound,
           .utf8 = false},
    Member{.name = "ORDER",
           .kind = Kind::enumeration,
           .offset = offsetof(MsgReq, ORDER),
           .key = true,
           .enum_name = "Order_t",
           .enumerators = orders},
};
constexpr std::array<std::size_t, 1> request_released = {request_members.size()};

constexpr std::array reply_members = {
    text("DEST_STATION", offsetof(MsgRes, DEST_STATION), kNameBound),
    number("CODE", Kind::uint32, offsetof(MsgRes, CODE)),
    number("ERROR", Kind::boolean, offsetof(MsgRes, ERROR)),
    number("STATUS", Kind::uint32, offsetof(MsgRes, STATUS)),
    text("BODY", offsetof(MsgRes, BODY), kBodyBound),
};
constexpr std::array<std::size_t, 1> reply_released = {reply_members.size()};

constexpr std::array status_members = {
    key("STATION", offsetof(Status, STATION)),
    number("STATE", Kind::uint32, offsetof(Status, STATE)),
    number("EPOCH", Kind::uint32, offsetof(Status, EPOCH)),
    number("READY", Kind::boolean, offsetof(Status, READY)),
    number("FAULT", Kind::uint32, offsetof(Status, FAULT)),
    text("CONTROLLER", offsetof(Status, CONTROLLER), kNameBound),
    number("SCANS", Kind::uint64, offsetof(Status, SCANS)),
    number("DEADLINE_MISSES", Kind::uint64, offsetof(Status, DEADLINE_MISSES)),
    number("WARNING", Kind::uint32, offsetof(Status, WARNING)),
    number("STOP_CAUSE", Kind::uint32, offsetof(Status, STOP_CAUSE)),
    number("STEP", Kind::uint32, offsetof(Status, STEP)),
    text("STEP_NAME", offsetof(Status, STEP_NAME)),
    number("PIECE", Kind::uint32, offsetof(Status, PIECE)),
    number("PERIOD_NS", Kind::int64, offsetof(Status, PERIOD_NS)),
    number("LATENESS_P99_NS", Kind::int64, offsetof(Status, LATENESS_P99_NS)),
    number("LATENESS_MAX_NS", Kind::int64, offsetof(Status, LATENESS_MAX_NS)),
    text("REALTIME", offsetof(Status, REALTIME)),
    number("SOURCE_TIME", Kind::int64, offsetof(Status, SOURCE_TIME)),
    number("FORCED", Kind::uint32, offsetof(Status, FORCED)),
};
constexpr std::array<std::size_t, 2> status_released = {18, status_members.size()};

constexpr std::array stats_plain = {
    key("STATION", offsetof(ScanStats, STATION)),
    text("TASK", offsetof(ScanStats, TASK), kNameBound),
    number("TASK_STATIONS", Kind::uint32, offsetof(ScanStats, TASK_STATIONS)),
    number("PERIOD_NS", Kind::int64, offsetof(ScanStats, PERIOD_NS)),
    number("SCANS", Kind::uint64, offsetof(ScanStats, SCANS)),
    number("DEADLINE_MISSES", Kind::uint64, offsetof(ScanStats, DEADLINE_MISSES)),
    number("SKIPPED", Kind::uint64, offsetof(ScanStats, SKIPPED)),
    number("MINUTE_SCANS", Kind::uint64, offsetof(ScanStats, MINUTE_SCANS)),
    number("MINUTE_DEADLINE_MISSES", Kind::uint64, offsetof(ScanStats, MINUTE_DEADLINE_MISSES)),
    number("MINUTE_SKIPPED", Kind::uint64, offsetof(ScanStats, MINUTE_SKIPPED)),
    number("SOURCE_TIME", Kind::int64, offsetof(ScanStats, SOURCE_TIME)),
};
constexpr std::array summary_members = {
    number("COUNT", Kind::uint64, offsetof(Summary, count)),
    number("MIN_NS", Kind::int64, offsetof(Summary, min_ns)),
    number("MEAN_NS", Kind::int64, offsetof(Summary, mean_ns)),
    number("P50_NS", Kind::int64, offsetof(Summary, p50_ns)),
    number("P99_NS", Kind::int64, offsetof(Summary, p99_ns)),
    number("P999_NS", Kind::int64, offsetof(Summary, p999_ns)),
    number("MAX_NS", Kind::int64, offsetof(Summary, max_ns)),
};
/// In the order of Window and Figure.
constexpr std::array<std::string_view, kWindows* kFigures> stats_groups = {
    "LATENESS",
    "EXECUTION",
    "RESPONSE",
    "TASK_EXECUTION",
    "TASK_RESPONSE",
    "LATCH",
    "EXECUTE",
    "COMMIT",
    "PUBLISH",
    "SERVICE",
    "MINUTE_LATENESS",
    "MINUTE_EXECUTION",
    "MINUTE_RESPONSE",
    "MINUTE_TASK_EXECUTION",
    "MINUTE_TASK_RESPONSE",
    "MINUTE_LATCH",
    "MINUTE_EXECUTE",
    "MINUTE_COMMIT",
    "MINUTE_PUBLISH",
    "MINUTE_SERVICE",
};
constexpr auto stats_members = [] {
  std::array<Member, stats_plain.size() + stats_groups.size() * summary_members.size()> all{};
  std::size_t n = 0;
  for (const Member& member : stats_plain) all[n++] = member;
  for (std::size_t group = 0; group < stats_groups.size(); ++group) {
    for (Member member : summary_members) {
      member.offset += offsetof(ScanStats, FIGURES) + group * sizeof(Summary);
      member.group = stats_groups[group];
      member.group_type = "Scan_Figure";
      all[n++] = member;
    }
  }
  return all;
}();
constexpr std::array<std::size_t, 1> stats_released = {stats_members.size()};

}  // namespace

template <> const TypeTable& table_of<Set>() noexcept {
  static const TypeTable type = table<Set>("PV_Set", set_members, set_released, 2);
  return type;
}
template <> const TypeTable& table_of<End>() noexcept {
  static const TypeTable type = table<End>("PV_End", end_members, end_released, 4);
  return type;
}
template <> const TypeTable& table_of<Gse>() noexcept {
  static const TypeTable type = table<Gse>("ASE_GSE", gse_members, gse_released, 2);
  return type;
}
template <> const TypeTable& table_of<MsgReq>() noexcept {
  static const TypeTable type = table<MsgReq>("Msg_Req", request_members, request_released, 3);
  return type;
}
template <> const TypeTable& table_of<MsgRes>() noexcept {
  static const TypeTable type = table<MsgRes>("Msg_Res", reply_members, reply_released, 5);
  return type;
}
template <> const TypeTable& table_of<Status>() noexcept {
  static const TypeTable type = table<Status>("PV_Status", status_members, status_released, 0);
  return type;
}
template <> const TypeTable& table_of<ScanStats>() noexcept {
  static const TypeTable type = table<ScanStats>("PV_ScanStats", stats_members, stats_released, 0);
  return type;
}

std::span<const TopicInfo> topics() noexcept {
  static const std::array<TopicInfo, kTopics> all = {{
      {TopicId::set, "Set", &table_of<Set>(), Service::pv, "STATION"},
      {TopicId::end, "End", &table_of<End>(), Service::pv, "STATION"},
      {TopicId::status, "Status", &table_of<Status>(), Service::pv, "STATION"},
      {TopicId::gse, "GSE", &table_of<Gse>(), Service::ase, ""},
      {TopicId::start, "Start", &table_of<MsgReq>(), Service::rnr, "DEST_STATION"},
      {TopicId::stop, "Stop", &table_of<MsgReq>(), Service::rnr, "DEST_STATION"},
      {TopicId::request, "Msg_Req", &table_of<MsgReq>(), Service::rr, "DEST_STATION"},
      {TopicId::reply, "Msg_Res", &table_of<MsgRes>(), Service::rr, "DEST_STATION"},
      {TopicId::stats, "ScanStats", &table_of<ScanStats>(), Service::diagnostic, "STATION"},
  }};
  return all;
}

const TopicInfo& topic(TopicId id) noexcept { return topics()[static_cast<std::size_t>(id)]; }

const TopicInfo* find_topic(std::string_view name) noexcept {
  const auto it = std::ranges::find(topics(), name, &TopicInfo::name);
  return it != topics().end() ? &*it : nullptr;
}

std::string cell_idl() {
  std::string idl =
      "// The cell's topics: Calvo et al. 2013, Table 4, with what was appended to it. Members may be "
      "appended at the\n"
      "// end, never put before or between. Encoding: XCDR1. Partition of publishers and subscribers: the "
      "cell's name.\n"
      "// Topic and type:\n";
  for (const TopicInfo& info : topics()) {
    idl.append("//   ")
        .append(info.name)
        .append(10 - info.name.size(), ' ')
        .append(info.type->name)
        .append("\n");
  }
  for (const TypeTable* type : {&table_of<Set>(), &table_of<End>(), &table_of<Gse>(), &table_of<MsgReq>(),
                                &table_of<MsgRes>(), &table_of<Status>(), &table_of<ScanStats>()}) {
    idl.append("\n").append(idl_of(*type));
  }
  return idl;
}

}  // namespace stationd::bus

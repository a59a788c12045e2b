// Member tables: IDL, encoding, key hashes; what a reader takes and what it refuses.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "dds_bridge/bus.hpp"
#include "dds_bridge/cell_types.hpp"
#include "dds_bridge/type_table.hpp"

namespace stationd::bus {
namespace {

using Bytes = std::vector<std::byte>;

template <class T> Bytes encoded(const T& message) {
  Bytes bytes(encoded_size(table_of<T>(), &message));
  REQUIRE(encode(table_of<T>(), &message, bytes) == bytes.size());
  return bytes;
}

template <class T> bool decoded(const Bytes& bytes, T& message) {
  return decode(table_of<T>(), bytes, &message);
}

/// A sample written by hand, as a foreign peer would, in either endianness.
class Foreign {
 public:
  explicit Foreign(bool little) : little_(little) {
    bytes_ = {std::byte{0}, std::byte(little ? 1 : 0), std::byte{0}, std::byte{0}};
  }
  Foreign& number(std::uint64_t value, std::size_t size) {
    while ((bytes_.size() - 4) % size != 0) bytes_.push_back(std::byte{0});
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t shift = 8 * (little_ ? i : size - 1 - i);
      bytes_.push_back(std::byte(static_cast<std::uint8_t>(value >> shift)));
    }
    return *this;
  }
  Foreign& text(const std::string& value) {
    number(value.size() + 1, 4);
    for (const char c : value) bytes_.push_back(std::byte(static_cast<unsigned char>(c)));
    bytes_.push_back(std::byte{0});
    return *this;
  }
  Foreign& raw(std::initializer_list<unsigned> values) {
    for (const unsigned value : values) bytes_.push_back(static_cast<std::byte>(value));
    return *this;
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  bool little_;
  Bytes bytes_;
};

TEST_CASE("cell_idl when compared with the shipped file then is the same [PV-5]") {
  std::ifstream file(STATIOND_SOURCE_DIR "/dds_bridge/cell.idl");
  std::ostringstream shipped;
  shipped << file.rdbuf();
  CHECK(shipped.str() == cell_idl());
}

TEST_CASE("tables when read then begin with the members of Table 4 [PV-5, ASE-4]") {
  const auto names = [](const TypeTable& table) {
    std::string all(table.name);
    for (std::size_t i = 0; i < table.paper_members; ++i) {
      const Member& member = table.members[i];
      all.append(member.key ? " @" : " ").append(member.name);
    }
    return all;
  };
  CHECK(names(table_of<Gse>()) == "ASE_GSE ERROR STATUS");
  CHECK(names(table_of<Set>()) == "PV_Set @STATION CODE");
  CHECK(names(table_of<End>()) == "PV_End @STATION CODE ERROR STATUS");
  CHECK(names(table_of<MsgReq>()) == "Msg_Req @DEST_STATION BODY @ORDER");
  CHECK(names(table_of<MsgRes>()) == "Msg_Res DEST_STATION CODE ERROR STATUS BODY");
  CHECK(table_of<Status>().name == "PV_Status");
}

TEST_CASE("released prefixes when another member follows then leave no doubt about padding") {
  for (const TopicInfo& info : topics()) {
    const TypeTable& table = *info.type;
    CHECK(table.released.back() == table.members.size());
    CHECK(std::ranges::is_sorted(table.released));
    for (const std::size_t released : table.released) {
      if (released == table.members.size()) continue;
      const bool whole = size_of(table.members[released - 1].kind) >= 4;
      const bool wide = size_of(table.members[released].kind) > 1;
      CHECK((whole || wide));
    }
  }
}

TEST_CASE("set when encoded then has the bytes of plain XCDR1") {
  const Set set{"ab", 0x01020304, true, 5, 6, 7};
  const std::array<unsigned, 32> expected = {0, 1, 0, 0, 3, 0, 0, 0, 'a', 'b', 0, 0, 4, 3, 2, 1,
                                             1, 0, 0, 0, 5, 0, 0, 0, 6,   0,   0, 0, 7, 0, 0, 0};
  const Bytes bytes = encoded(set);
  REQUIRE(bytes.size() == 32);
  for (std::size_t i = 0; i < bytes.size(); ++i) CHECK(static_cast<unsigned>(bytes[i]) == expected[i]);
}

TEST_CASE("status when encoded and decoded then is the same") {
  Status status;
  status.STATION = "robot";
  status.STATE = 3;
  status.EPOCH = 9;
  status.READY = true;
  status.FAULT = 2101;
  status.CONTROLLER = "controller1";
  status.SCANS = 1ULL << 60U;
  status.WARNING = 1203;
  status.STEP_NAME = "fit the shaft";
  status.LATENESS_MAX_NS = -5;
  status.REALTIME = "FIFO refused: \xC3\xA4";
  status.SOURCE_TIME = 1'700'000'000'123'456'789;
  status.FORCED = 3;
  Status back;
  REQUIRE(decoded(encoded(status), back));
  CHECK(encoded(back) == encoded(status));
  CHECK(back.REALTIME == status.REALTIME);
  CHECK(back.SCANS == status.SCANS);
  CHECK(back.SOURCE_TIME == status.SOURCE_TIME);
  CHECK(back.FORCED == 3);
}

TEST_CASE("statistics when encoded and decoded then are the same, each figure in its place [SCAN-6]") {
  ScanStats stats;
  stats.STATION = "robot";
  stats.TASK = "main";
  stats.TASK_STATIONS = 2;
  stats.MINUTE_SKIPPED = 3;
  std::int64_t n = 1'000;
  for (auto& window : stats.FIGURES) {
    for (Summary& s : window) {
      s.count = static_cast<std::uint64_t>(n++);
      for (std::int64_t* ns : {&s.min_ns, &s.mean_ns, &s.p50_ns, &s.p99_ns, &s.p999_ns, &s.max_ns}) *ns = n++;
    }
  }
  const Bytes bytes = encoded(stats);
  CHECK(bytes.size() < 1'400);  // one packet of an Ethernet
  ScanStats back;
  REQUIRE(decoded(bytes, back));
  CHECK(encoded(back) == bytes);
  CHECK(back.FIGURES[1][static_cast<std::size_t>(Figure::service)].max_ns == n - 1);
  const std::span<const Member> members = table_of<ScanStats>().members;
  for (std::size_t w = 0; w < kWindows; ++w) {
    for (std::size_t f = 0; f < kFigures; ++f) {
      std::string name(w == 0 ? "" : "MINUTE_");
      for (const char c : name_of(static_cast<Figure>(f))) name += static_cast<char>(std::toupper(c));
      CHECK(members[11 + (w * kFigures + f) * 7].group == name);
    }
  }
}

TEST_CASE("set when it ends after Table 4 then is read with defaults [PV-5]") {
  for (const bool little : {true, false}) {
    CAPTURE(little);
    Set set{"old", 1, true, 1, 1, 1};
    REQUIRE(decoded(Foreign(little).text("loader").number(101, 4).bytes(), set));
    CHECK(set.STATION == "loader");
    CHECK(set.CODE == 101);
    CHECK_FALSE(set.ERROR);
    CHECK(set.SEQ == 0);
  }
}

TEST_CASE("end and event when they end after Table 4 then are read with defaults [PV-5, ASE-4]") {
  for (const bool little : {true, false}) {
    CAPTURE(little);
    End end;
    REQUIRE(decoded(Foreign(little).text("r").number(102, 4).number(1, 1).number(7, 4).bytes(), end));
    CHECK(end.ERROR);
    CHECK(end.STATUS == 7);
    CHECK(end.EPOCH == 0);
    Gse event;
    REQUIRE(decoded(Foreign(little).number(1, 1).number(2101, 4).bytes(), event));
    CHECK(event.ERROR);
    CHECK(event.STATUS == 2101);
    CHECK(event.EDGE);
    CHECK(event.STATION.empty());
  }
}

TEST_CASE("status when it is of the release before FORCED then is read with none forced [IMG-3, PV-5]") {
  Status status;
  status.STATION = "robot";
  status.SOURCE_TIME = 12;
  status.FORCED = 3;
  Bytes bytes = encoded(status);
  bytes.resize(bytes.size() - 4);
  Status back;
  REQUIRE(decoded(bytes, back));
  CHECK(back.SOURCE_TIME == 12);
  CHECK(back.FORCED == 0);
}

TEST_CASE("set when it ends between releases then is malformed") {
  Set set;
  CHECK_FALSE(decoded(Foreign(true).text("loader").bytes(), set));
  CHECK_FALSE(decoded(Foreign(true).text("loader").number(1, 4).number(0, 1).number(0, 4).bytes(), set));
  CHECK(set.STATION.empty());
}

TEST_CASE("set when a newer release appended members then is read without them") {
  Set set;
  REQUIRE(decoded(Foreign(true)
                      .text("loader")
                      .number(1, 4)
                      .number(1, 1)
                      .number(2, 4)
                      .number(3, 4)
                      .number(4, 4)
                      .number(99, 8)
                      .text("more")
                      .bytes(),
                  set));
  CHECK(set.SEQ == 4);
}

TEST_CASE("request when written by a Table 4 peer then is read in both byte orders [REQ-1]") {
  for (const bool little : {true, false}) {
    CAPTURE(little);
    MsgReq request;
    REQUIRE(decoded(Foreign(little).text("robot").text("status id=4").number(2, 4).bytes(), request));
    CHECK(request.DEST_STATION == "robot");
    CHECK(request.BODY == "status id=4");
    CHECK(request.ORDER == Order::MSG);
  }
}

TEST_CASE("sample when malformed then is refused and leaves defaults") {
  MsgReq request;
  Set set;
  Gse event;
  Foreign two = Foreign(true).number(2, 1).number(1, 4);
  CHECK_FALSE(decoded(two.bytes(), event));
  CHECK_FALSE(decoded(Foreign(true).text("robot").text("").number(3, 4).bytes(), request));   // unknown enum
  CHECK_FALSE(decoded(Foreign(true).text(std::string(256, 'x')).number(1, 4).bytes(), set));  // key too long
  CHECK_FALSE(decoded(Foreign(true).number(1000, 4).number(1, 4).bytes(), set));              // too short
  CHECK_FALSE(decoded(Foreign(true).number(0xFFFFFFFF, 4).number(1, 4).bytes(), set));
  CHECK_FALSE(decoded(Foreign(true).number(0, 4).number(1, 4).bytes(), set));  // no terminator
  CHECK_FALSE(decoded(Foreign(true).number(3, 4).raw({'a', 'b', 'c', 0}).number(1, 4).bytes(), set));
  CHECK_FALSE(
      decoded(Foreign(true).number(4, 4).raw({'a', 0, 'c', 0}).number(1, 4).bytes(), set));  // inner NUL
  CHECK_FALSE(decoded(Foreign(true).number(3, 4).raw({0xC3, 'b', 0}).number(1, 4).bytes(), set));  // no UTF-8
  CHECK_FALSE(decoded(Bytes{}, set));
  CHECK_FALSE(decoded(Bytes{std::byte{0}, std::byte{1}}, set));
  for (const unsigned id : {2U, 3U, 6U, 7U, 255U}) {  // parameter lists, XCDR2, nonsense
    Bytes other = encoded(Set{"loader", 1});
    other[1] = static_cast<std::byte>(id);
    CHECK_FALSE(decoded(other, set));
  }
  CHECK(set.STATION.empty());
  CHECK(request.DEST_STATION.empty());
}

TEST_CASE("body when not UTF-8 then still arrives, to be refused with an answer [REQ-5]") {
  MsgReq request;
  REQUIRE(
      decoded(Foreign(true).text("robot").number(3, 4).raw({0xFF, 0xFE, 0}).number(2, 4).bytes(), request));
  CHECK(request.BODY == "\xFF\xFE");
}

TEST_CASE("decoder when fed random bytes then neither throws nor reads beyond") {
  std::mt19937 random(7);
  const Bytes good = encoded(End{"sealer", 103, false, 0, 1, 2});
  int taken = 0;
  for (int i = 0; i < 200'000; ++i) {
    Bytes bytes = good;
    const int changes = 1 + static_cast<int>(random() % 3);
    for (int k = 0; k < changes; ++k) bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    bytes.resize(random() % (bytes.size() + 1));
    bytes.shrink_to_fit();
    End end;
    taken += decoded(bytes, end) ? 1 : 0;
    CHECK(end.STATION.size() <= kNameBound);
  }
  CHECK(taken > 0);
}

TEST_CASE("text when longer than its bound then is not encoded") {
  const Set set{std::string(256, 'x'), 1};
  CHECK(encoded_size(table_of<Set>(), &set) == 0);
  KeyHash hash;
  CHECK_FALSE(key_hash(table_of<Set>(), &set, false, hash));
  Bytes bytes(1000);
  CHECK(encode(table_of<Set>(), &set, bytes) == 0);
  const Set fits{std::string(255, 'x'), 1};
  CHECK(encode(table_of<Set>(), &fits, std::span(bytes).first(20)) == 0);
  CHECK(encode(table_of<Set>(), &fits, bytes) != 0);
}

std::string hex(const KeyHash& hash) {
  std::string text;
  for (const std::uint8_t byte : hash) {
    text += "0123456789abcdef"[byte >> 4U];
    text += "0123456789abcdef"[byte & 15U];
  }
  return text;
}

TEST_CASE("key_hash when the key can be long then is MD5 of the big-endian key") {
  KeyHash hash;
  const Set set{"loader", 101};
  REQUIRE(key_hash(table_of<Set>(), &set, false, hash));
  // printf '\0\0\0\7loader\0' | md5sum
  CHECK(hex(hash) == "84d52c795b362dc8ca775db3f5d7d545");
  const MsgReq request{"robot", "whatever", Order::MSG};
  REQUIRE(key_hash(table_of<MsgReq>(), &request, false, hash));
  // printf '\0\0\0\6robot\0\0\0\0\0\0\2' | md5sum
  CHECK(hex(hash) == "bd35bc04914f1611fb4a368c03ebe439");
}

TEST_CASE("key_hash when no key can be longer than 16 bytes then is the key itself") {
  struct Small {
    std::uint32_t A;
    std::uint16_t B;
  };
  static constexpr std::array members = {
      Member{.name = "A", .kind = Kind::uint32, .offset = offsetof(Small, A), .key = true},
      Member{.name = "B", .kind = Kind::uint16, .offset = offsetof(Small, B), .key = true}};
  static constexpr std::array<std::size_t, 1> released = {2};
  const TypeTable table{.name = "Small", .members = members, .released = released};
  const Small small{0x01020304, 0x0506};
  KeyHash hash;
  REQUIRE(key_hash(table, &small, false, hash));
  CHECK(hex(hash) == "01020304050600000000000000000000");
}

TEST_CASE("peek_text when the member stands behind others then finds it") {
  const MsgRes reply{"client", 1, true, 2, "done"};
  const Bytes bytes = encoded(reply);
  CHECK(peek_text(table_of<MsgRes>(), "DEST_STATION", bytes) == "client");
  CHECK(peek_text(table_of<MsgRes>(), "BODY", bytes) == "done");
  CHECK_FALSE(peek_text(table_of<MsgRes>(), "CODE", bytes).has_value());
  const Bytes big = Foreign(false).text("robot").number(1, 4).bytes();
  CHECK(peek_text(table_of<Set>(), "STATION", big) == "robot");
  const Bytes cut(bytes.begin(), bytes.begin() + 9);
  CHECK_FALSE(peek_text(table_of<MsgRes>(), "DEST_STATION", cut).has_value());
}

TEST_CASE("is_utf8 when bytes are ill-formed then says so") {
  for (const char* good : {"", "abc", "\xC3\xA4", "\xE2\x82\xAC", "\xF0\x9F\x98\x80", "\xEF\xBF\xBF"})
    CHECK(is_utf8(good));
  for (const char* bad : {"\x80", "\xC3", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80",
                          "\xF8\x88", "a\xC3(", "\xFF"}) {
    CHECK_FALSE(is_utf8(bad));
  }
}

}  // namespace
}  // namespace stationd::bus

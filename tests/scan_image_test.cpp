// Values and the process image: names, places, initial values, and the handles by which a program sees them.
#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <limits>
#include <memory>
#include <string>

#include "scan/codes.hpp"
#include "scan/error.hpp"
#include "scan/image.hpp"
#include "tests/scan_fixture.hpp"

namespace stationd {
namespace {

TagSpec spec(std::string name, TagType type = TagType::BOOL, std::uint16_t length = 0) {
  TagSpec s;
  s.name = std::move(name);
  s.type = type;
  s.length = length;
  return s;
}

template <class T> void check_round_trip(T value) { CHECK(from_slot<T>(to_slot(value)) == value); }

TEST_CASE_TEMPLATE("slot of an extreme value gives the value back [IMG-1]", T, std::int8_t, std::int16_t,
                   std::int32_t, std::int64_t, std::uint8_t, std::uint16_t, std::uint32_t, std::uint64_t,
                   float, double) {
  check_round_trip(std::numeric_limits<T>::lowest());
  check_round_trip(std::numeric_limits<T>::max());
  check_round_trip(T{0});
  check_round_trip(T{1});
}

TEST_CASE("slot of a signed value is sign-extended [IMG-1]") {
  CHECK(to_slot<std::int8_t>(-1) == ~Slot{0});
  CHECK(to_slot<std::uint8_t>(255) == Slot{255});
}

TEST_CASE("slot of BOOL and TIME gives the value back [IMG-1]") {
  check_round_trip(true);
  check_round_trip(false);
  CHECK(from_slot<bool>(Slot{2}));
  CHECK(from_slot<Time>(to_slot(Time{-5})).ns == -5);
}

TEST_CASE("slot of REAL keeps the bits of a NaN [IMG-1]") {
  const Slot slot = to_slot(std::numeric_limits<float>::quiet_NaN());
  CHECK(to_slot(from_slot<float>(slot)) == slot);
}

TEST_CASE("integer range of each type is IEC 61131-3's [IMG-1]") {
  CHECK(integer_range(TagType::BOOL).max == 1);
  CHECK(integer_range(TagType::SINT).min == -128);
  CHECK(integer_range(TagType::INT).max == 32767);
  CHECK(integer_range(TagType::DINT).min == -2147483648LL);
  CHECK(integer_range(TagType::USINT).max == 255);
  CHECK(integer_range(TagType::UINT).max == 65535);
  CHECK(integer_range(TagType::UDINT).max == 4294967295LL);
  CHECK(integer_range(TagType::UDINT).min == 0);
  CHECK(integer_range(TagType::LINT).min == std::numeric_limits<std::int64_t>::min());
  CHECK(integer_range(TagType::ULINT).min == 0);
}

TEST_CASE("names of types, qualities, areas and states are those of the vocabulary") {
  CHECK(name_of(TagType::BOOL) == "BOOL");
  CHECK(name_of(TagType::STRING) == "STRING");
  CHECK(name_of(Quality::FORCED) == "FORCED");
  CHECK(name_of(Area::retained) == "retained");
  CHECK(name_of(StationState::FAULT) == "FAULT");
  CHECK(name_of(Severity::fault) == "fault");
}

TEST_CASE("worse of two qualities is the smaller one") {
  CHECK(std::min(Quality::GOOD, Quality::STALE) == Quality::STALE);
  CHECK(std::min(Quality::STALE, Quality::BAD) == Quality::BAD);
  CHECK(std::min(Quality::FORCED, Quality::GOOD) == Quality::GOOD);
}

TEST_CASE("code table gives each code its row and unknown ones none") {
  for (const CodeInfo& info : all_codes()) CHECK(find_code(info.code) == &info);
  CHECK(find_code(0) == nullptr);
  CHECK(find_code(999'999) == nullptr);
}

TEST_CASE("image refuses names that are empty or malformed [IMG-1]") {
  Image image;
  for (const char* bad : {"", "a b", "a/b", "a-b", "\xc3\xa4", "a\n"})
    CHECK_THROWS_AS(image.add(spec(bad)), SetupError);
  CHECK_NOTHROW(image.add(spec("Arm.position_1")));
  CHECK(image.size() == 1);
}

TEST_CASE("image refuses a name that is taken and keeps the first tag [IMG-1]") {
  Image image;
  const TagIndex first = image.add(spec("a", TagType::INT));
  CHECK_THROWS_WITH_AS(image.add(spec("a")), doctest::Contains("\"a\""), SetupError);
  CHECK(image.find("a") == first);
  CHECK(image.spec(first).type == TagType::INT);
}

TEST_CASE("image refuses a string without length or above 255 bytes [IMG-1]") {
  Image image;
  CHECK_THROWS_AS(image.add(spec("s", TagType::STRING, 0)), SetupError);
  CHECK_THROWS_AS(image.add(spec("s", TagType::STRING, 256)), SetupError);
  CHECK_NOTHROW(image.add(spec("s", TagType::STRING, 255)));
}

TEST_CASE("image refuses tags after it was sealed") {
  Image image;
  image.seal();
  CHECK_THROWS_AS(image.add(spec("late")), SetupError);
}

TEST_CASE("image finds no tag that was not added") {
  Image image;
  image.add(spec("a"));
  CHECK_FALSE(image.find("b").has_value());
  CHECK_FALSE(image.find("").has_value());
}

TEST_CASE("string takes one slot and one for each eight bytes, before and after seal") {
  Image image;
  const TagIndex s1 = image.add(spec("s1", TagType::STRING, 1));
  const TagIndex s8 = image.add(spec("s8", TagType::STRING, 8));
  const TagIndex s9 = image.add(spec("s9", TagType::STRING, 9));
  const TagIndex b = image.add(spec("b"));
  CHECK(image.slot_count(s9) == 3);
  image.seal();
  CHECK(image.slot_count(s1) == 2);
  CHECK(image.slot_count(s8) == 2);
  CHECK(image.slot_count(s9) == 3);
  CHECK(image.slot_count(b) == 1);
  CHECK(image.value(b) == image.value(s1) + 7);
}

TEST_CASE("sealed image holds the initial values; inputs are BAD until they are seen [IMG-2]") {
  Image image;
  TagSpec in = spec("in", TagType::INT);
  in.area = Area::input;
  in.initial = 4;
  TagSpec own = spec("own", TagType::INT);
  own.initial = 9;
  const TagIndex i = image.add(in);
  const TagIndex o = image.add(own);
  image.seal();
  CHECK(*image.value(i) == 4);
  CHECK(*image.quality(i) == Quality::BAD);
  CHECK(*image.value(o) == 9);
  CHECK(*image.quality(o) == Quality::GOOD);
}

TEST_CASE("block view puts header, slots and qualities one behind the other") {
  const BlockLayout layout{3, 2};
  alignas(BlockHeader) std::array<std::byte, 128> bytes{};
  const BlockView view{bytes.data(), layout};
  view.header().scan = 11;
  view.slots()[2] = 22;
  view.qualities()[1] = Quality::STALE;
  CHECK(layout.size_bytes() == sizeof(BlockHeader) + 26);
  const ConstBlockView again{bytes.data(), layout};
  CHECK(again.header().scan == 11);
  CHECK(again.slots()[2] == 22);
  CHECK(again.qualities()[1] == Quality::STALE);
  CHECK(std::to_integer<int>(bytes[sizeof(BlockHeader) + 25]) == static_cast<int>(Quality::STALE));
}

TEST_CASE("handles read and write the tags of their names") {
  test::StationRig rig;
  Image& image = rig.station->image();
  CHECK(rig.program->code == 7U);
  CHECK(rig.program->limit == 5);
  rig.program->code = 8;
  rig.program->speed = -3;
  CHECK(*image.value(*image.find("code")) == 8);
  CHECK(from_slot<std::int32_t>(*image.value(*image.find("speed"))) == -3);
  *image.value(*image.find("position")) = to_slot<std::int32_t>(-77);
  *image.quality(*image.find("position")) = Quality::STALE;
  CHECK(rig.program->position == -77);
  CHECK(rig.program->position.quality() == Quality::STALE);
  CHECK_FALSE(rig.program->position.good());
  *image.quality(*image.find("position")) = Quality::FORCED;
  CHECK(rig.program->position.good());
}

TEST_CASE("parameter declares its limits, output its hold") {
  const test::StationRig rig;
  CHECK(from_slot<std::int32_t>(rig.program->limit.spec().max) == 100);
  CHECK(rig.program->limit.spec().parameter);
  CHECK(rig.program->gripper.spec().hold);
  CHECK_FALSE(rig.program->valve.spec().hold);
}

TEST_CASE("recipe value that is missing or out of range is named with its recipe") {
  Recipe recipe;
  recipe.code = 12;
  recipe.values = {{"press_time", 5}};
  CHECK(recipe.value("press_time", 0, 10) == 5);
  CHECK_THROWS_WITH_AS(recipe.value("press_time", 6, 10), doctest::Contains("press_time is 5"), SetupError);
  CHECK_THROWS_WITH_AS(recipe.value("glue", 0, 1), doctest::Contains("recipe 12: glue"), SetupError);
}

}  // namespace
}  // namespace stationd

// Bodies of requests, values of parameters, the log's throttle, the watch for duplicates.
#include <doctest/doctest.h>

#include <random>
#include <string>
#include <vector>

#include "dds_bridge/body.hpp"
#include "dds_bridge/duplicate.hpp"
#include "dds_bridge/histogram_body.hpp"
#include "dds_bridge/throttle.hpp"
#include "dds_bridge/type_table.hpp"
#include "dds_bridge/values.hpp"

namespace stationd::bus {
namespace {

constexpr std::size_t kMax = 8192;

TEST_CASE("body when well formed then gives verb, arguments, pairs and addresses") {
  const Body body = parse_body("  describe ST1203\tspeed=5 from=desk id=17\n", kMax);
  REQUIRE(body.ok());
  CHECK(body.words == std::vector<std::string>{"describe", "ST1203"});
  REQUIRE(body.pairs.size() == 1);
  CHECK(body.pairs[0] == std::pair<std::string, std::string>{"speed", "5"});
  CHECK(body.from == "desk");
  CHECK(body.id == "17");
  CHECK(reply_prefix(body) == "id=17 ");
}

std::uint64_t total(const HistogramBody& body) {
  std::uint64_t sum = 0;
  for (const BucketCount& b : body.buckets) sum += b.count;
  return sum;
}

TEST_CASE("histogram when written and read then is the same [SCAN-6]") {
  const HistogramBody said{Figure::response, Window::last_minute, 1, {{3, 7}, {1'000, 2}, {2'112, 1}}};
  const std::string text = histogram_text(said, kMax);
  CHECK(text == "figure=response window=last_minute merged=1 3:7 1000:2 2112:1");
  const auto heard = parse_histogram(text);
  REQUIRE(heard.has_value());
  CHECK(heard->figure == Figure::response);
  CHECK(heard->window == Window::last_minute);
  CHECK(total(*heard) == 10);
  CHECK(heard->buckets[1].bucket == 1'000);
  CHECK(heard->low_ns(3) == 3);
  CHECK(heard->end_ns(3) == 4);
  CHECK(heard->end_ns(2'112) == INT64_MAX);
}

TEST_CASE("histogram when too long for a body then gets coarser and keeps every count [SCAN-6]") {
  HistogramBody full;
  for (std::size_t i = 0; i < Buckets::kCount; ++i) full.buckets.push_back({i, UINT64_MAX / 10'000});
  for (const std::size_t limit : {std::size_t{128}, std::size_t{1'024}, kMax, 2 * kMax}) {
    const std::string text = histogram_text(full, limit);
    CHECK(text.size() <= limit);
    const auto heard = parse_histogram(text);
    REQUIRE(heard.has_value());
    CHECK(total(*heard) == total(full));
    CHECK(heard->end_ns(heard->buckets.back().bucket) == INT64_MAX);
    const bool apart = heard->low_ns(heard->buckets.back().bucket) == Buckets::low_ns(Buckets::kOverflow);
    CHECK(apart == (limit > 128));
    CHECK(heard->low_ns(0) == 0);
  }
}

TEST_CASE("histogram when it is not one then is refused, and a newer release's word is not") {
  for (const char* text :
       {"", "done", "figure=speed", "figure=execute window=hour", "figure=execute merged=0",
        "figure=execute merged=5000", "figure=execute 5:", "figure=execute :5", "figure=execute 9999:1",
        "figure=execute 5:1 5:1", "figure=execute 5:-1", "figure=execute merged=64 34:1",
        "figure=execute 18446744073709551615:1"})
    CHECK_MESSAGE(!parse_histogram(text).has_value(), text);
  const auto newer = parse_histogram("figure=execute merged=2 unit=ns hello 5:1");
  REQUIRE(newer.has_value());
  CHECK(newer->low_ns(newer->buckets[0].bucket) == 10);
}

TEST_CASE("body when empty then is well formed and says nothing") {
  const Body body = parse_body("", kMax);
  CHECK(body.ok());
  CHECK(body.words.empty());
  CHECK(reply_prefix(body).empty());
}

TEST_CASE("body when a value holds an equals sign then keeps it") {
  CHECK(parse_body("a=b=c", kMax).pairs[0].second == "b=c");
  CHECK(parse_body("a=", kMax).pairs[0].second.empty());
}

TEST_CASE("body when ill formed then is refused and still says who asked [REQ-5]") {
  const std::string address = " from=desk id=5";
  for (const std::string& bad :
       {std::string("=1"), std::string("a=1 a=2"), std::string("x\xFF"), std::string("x\x01"),
        std::string("x\x7F"), std::string("x", 1) + std::string(kMax, 'y')}) {
    const Body body = parse_body(bad + address, kMax);
    CHECK_FALSE(body.ok());
    CHECK(body.words.empty());
    CHECK(body.pairs.empty());
    CHECK(body.from == "desk");
    CHECK(body.id == "5");
  }
}

TEST_CASE("body when its address is ill formed then is refused [REQ-5]") {
  CHECK_FALSE(parse_body("from=a from=b", kMax).ok());
  CHECK_FALSE(parse_body("id=1 id=2", kMax).ok());
  CHECK_FALSE(parse_body("id=" + std::string(65, '1'), kMax).ok());
  CHECK_FALSE(parse_body("from=" + std::string(256, 'a'), kMax).ok());
  CHECK(parse_body("from=" + std::string(255, 'a'), kMax).ok());
  CHECK(parse_body("from=\xFF id=3", kMax).from.empty());
}

TEST_CASE("body when as long as allowed then is taken, one byte more then not [REQ-5]") {
  CHECK(parse_body(std::string(kMax, 'a'), kMax).ok());
  CHECK_FALSE(parse_body(std::string(kMax + 1, 'a'), kMax).ok());
}

TEST_CASE("body when random then what it yields is well formed [REQ-5]") {
  std::mt19937 random(11);
  constexpr std::string_view alphabet = "ab=  \t\nfromid=id=from=\xC3\xA4\xFF\x01";
  for (int i = 0; i < 100'000; ++i) {
    std::string text(random() % 40, ' ');
    const bool any_byte = random() % 4 == 0;
    for (char& c : text) c = any_byte ? static_cast<char>(random()) : alphabet[random() % alphabet.size()];
    const Body body = parse_body(text, 32);
    std::string all = body.from + body.id;
    for (const std::string& word : body.words) {
      CHECK_FALSE(word.empty());
      CHECK(word.find_first_of("= \t\r\n") == std::string::npos);
      all += word;
    }
    for (const auto& [key, value] : body.pairs) {
      CHECK_FALSE(key.empty());
      CHECK(key.find_first_of("= \t\r\n") == std::string::npos);
      all += key + value;
    }
    CHECK(is_utf8(all));
    CHECK(body.ok() == body.problem.empty());
  }
}

TEST_CASE("clipped when the cut would split a character then leaves it out") {
  CHECK(clipped("abc", 3) == "abc");
  CHECK(clipped("abcd", 3) == "abc");
  CHECK(clipped("ab\xC3\xA4", 3) == "ab");
  CHECK(clipped("\xF0\x9F\x98\x80", 3).empty());
}

TagSpec parameter(TagType type, Slot min, Slot max) {
  TagSpec spec;
  spec.name = "p";
  spec.type = type;
  spec.parameter = true;
  spec.min = min;
  spec.max = max;
  return spec;
}

TEST_CASE("value when of its type and in range then is taken [REQ-3]") {
  const auto slot = [](const TagSpec& spec, const char* text) {
    const ParsedValue value = parse_value(spec, text);
    CAPTURE(value.problem);
    CHECK(value.problem.empty());
    return value.slot;
  };
  CHECK(slot(parameter(TagType::BOOL, 0, 0), "true") == 1);
  CHECK(slot(parameter(TagType::BOOL, 0, 0), "0") == 0);
  CHECK(slot(parameter(TagType::INT, 0, 0), "-32768") == static_cast<Slot>(-32768));
  CHECK(slot(parameter(TagType::ULINT, 0, 0), "18446744073709551615") == ~Slot{0});
  CHECK(from_slot<float>(slot(parameter(TagType::REAL, 0, 0), "1.5")) == 1.5F);
  CHECK(from_slot<double>(slot(parameter(TagType::LREAL, to_slot(-1.0), to_slot(1.0)), "-0.5")) == -0.5);
  const TagSpec time = parameter(TagType::TIME, 0, Slot{10'000'000'000});
  CHECK(slot(time, "300ms") == 300'000'000);
  CHECK(slot(time, "1.5s") == 1'500'000'000);
  CHECK(slot(time, "0s") == 0);
  CHECK(slot(parameter(TagType::TIME, 0, 0), "2min") == 120'000'000'000);
  CHECK(slot(parameter(TagType::TIME, 0, 0), "-5us") == static_cast<Slot>(-5000));
}

TEST_CASE("value when not of its type or out of range then is refused [REQ-3, REQ-5]") {
  const auto refused = [](const TagSpec& spec, const char* text) {
    CAPTURE(text);
    return !parse_value(spec, text).problem.empty();
  };
  CHECK(refused(parameter(TagType::BOOL, 0, 0), "yes"));
  CHECK(refused(parameter(TagType::INT, 0, 0), "32768"));
  CHECK(refused(parameter(TagType::INT, 0, 0), "1.0"));
  CHECK(refused(parameter(TagType::INT, 0, 0), ""));
  CHECK(refused(parameter(TagType::INT, 0, 0), " 1"));
  CHECK(refused(parameter(TagType::UINT, 5, 10), "4"));
  CHECK(refused(parameter(TagType::UINT, 5, 10), "11"));
  CHECK(refused(parameter(TagType::UDINT, 0, 0), "-1"));
  CHECK(refused(parameter(TagType::LREAL, to_slot(-1.0), to_slot(1.0)), "1.5"));
  CHECK(refused(parameter(TagType::LREAL, 0, 0), "nan"));
  CHECK(refused(parameter(TagType::REAL, 0, 0), "inf"));
  const TagSpec time = parameter(TagType::TIME, 0, Slot{10'000'000'000});
  for (const char* bad : {"300", "ms", "11s", "-1ms", "1e3s", "9e99h", "99999999999999999h", "1 s", "1sec"}) {
    CHECK(refused(time, bad));
  }
  CHECK(refused(parameter(TagType::STRING, 0, 0), "x"));
}

TEST_CASE("value when written for people then is read back as the same") {
  const auto again = [](TagType type, Slot slot) {
    return parse_value(parameter(type, 0, 0), format_value(type, slot)).slot == slot;
  };
  CHECK(format_value(TagType::TIME, 300'000'000) == "300ms");
  CHECK(format_value(TagType::TIME, 1'500'000'000) == "1500ms");
  CHECK(format_value(TagType::BOOL, 1) == "true");
  CHECK(again(TagType::REAL, to_slot(0.1F)));
  CHECK(again(TagType::LREAL, to_slot(0.1)));
  CHECK(again(TagType::TIME, 123'456'789));
  CHECK(again(TagType::LINT, static_cast<Slot>(-7)));
  CHECK(format_range(parameter(TagType::TIME, 100'000'000, Slot{10'000'000'000})) == "100ms..10s");
  CHECK(format_range(parameter(TagType::UINT, 0, 0)) == "0..65535");
  CHECK(format_range(parameter(TagType::BOOL, 0, 0)).empty());
}

TEST_CASE("throttle when lines of a kind crowd then says one a second and how many it stands for") {
  std::vector<std::string> lines;
  Throttle throttle([&](int, const std::string& text) { lines.push_back(text); });
  constexpr std::int64_t second = 1'000'000'000;
  for (int i = 0; i < 10; ++i) throttle.say("a", 2, "line " + std::to_string(i), second + i);
  throttle.say("b", 2, "other", second);
  CHECK(lines == std::vector<std::string>{"line 0", "other"});
  throttle.flush(second + second / 2);
  CHECK(lines.size() == 2);
  throttle.flush(2 * second);
  REQUIRE(lines.size() == 3);
  CHECK(lines[2] == "line 9 (9 such)");
  throttle.flush(9 * second);
  CHECK(lines.size() == 3);
}

constexpr std::int64_t kWindow = 3'000'000'000;

Status alive(std::uint64_t scans) {
  Status status;
  status.STATION = "robot";
  status.SCANS = scans;
  status.PERIOD_NS = 10'000'000;
  return status;
}

Origin origin_of(std::uint64_t high, std::int64_t sequence) {
  Origin origin;
  origin.writer_high = high;
  origin.sequence = sequence;
  return origin;
}

TEST_CASE("duplicate_watch when another daemon was here before then gives way at its second sample") {
  using Verdict = DuplicateWatch::Verdict;
  DuplicateWatch watch(origin_of(5, 0), kWindow);
  watch.start(0);
  CHECK(watch.on_status(alive(1000), origin_of(9, 70), 1) == Verdict::none);
  CHECK(watch.on_status(alive(1000), origin_of(9, 70), 2) == Verdict::none);  // the same once more
  CHECK(watch.on_status(alive(1001), origin_of(9, 71), 3) == Verdict::give_way);
}

TEST_CASE("duplicate_watch when it hears itself or a single late sample then says nothing") {
  using Verdict = DuplicateWatch::Verdict;
  DuplicateWatch watch(origin_of(5, 0), kWindow);
  watch.start(0);
  CHECK(watch.on_status(alive(1), origin_of(5, 1), 1) == Verdict::none);
  CHECK(watch.on_status(alive(2), origin_of(5, 2), 2) == Verdict::none);
  CHECK(watch.on_status(alive(90'000), origin_of(4, 900), 3) ==
        Verdict::none);  // of a daemon killed just now
}

TEST_CASE("duplicate_watch when both are new then exactly one gives way") {
  using Verdict = DuplicateWatch::Verdict;
  DuplicateWatch five(origin_of(5, 0), kWindow), nine(origin_of(9, 0), kWindow);
  five.start(0);
  nine.start(0);
  five.on_status(alive(1), origin_of(9, 1), 1);
  nine.on_status(alive(1), origin_of(5, 1), 1);
  CHECK(five.on_status(alive(2), origin_of(9, 2), 2) == Verdict::report);
  CHECK(nine.on_status(alive(2), origin_of(5, 2), 2) == Verdict::give_way);
}

TEST_CASE("duplicate_watch when it has run for long then reports and goes on") {
  using Verdict = DuplicateWatch::Verdict;
  DuplicateWatch watch(origin_of(9, 0), kWindow);
  watch.start(0);
  watch.on_status(alive(1000), origin_of(5, 1), kWindow);
  CHECK(watch.on_status(alive(1001), origin_of(5, 2), kWindow + 1) == Verdict::report);
}

}  // namespace
}  // namespace stationd::bus

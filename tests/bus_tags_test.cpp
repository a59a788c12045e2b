// Requests about tags: what is taken, what is refused and why, and what is said of it.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "dds_bridge/tag_orders.hpp"
#include "scan/codes.hpp"
#include "scan/forces.hpp"
#include "scan/program.hpp"

namespace stationd::bus {
namespace {

TagSpec writable(TagSpec spec, Slot min, Slot max) {
  spec.writable = true;
  spec.min = min;
  spec.max = max;
  return spec;
}

struct Tags {
  Tags() {
    image.add(tag_spec<bool>("part_present", Area::input, ""));
    image.add(tag_spec<std::int16_t>("offset", Area::input, ""));
    image.add(tag_spec<bool>("conveyor", Area::output, ""));
    TagSpec time = tag_spec<Time>("press_time", Area::internal, "", Time{300'000'000});
    time.parameter = true;
    time.unit = "t";
    image.add(writable(time, 100'000'000, 5'000'000'000));
    TagSpec fixed = tag_spec<std::uint16_t>("speed", Area::internal, "");
    fixed.parameter = true;
    image.add(fixed);
    image.add(writable(tag_spec<std::uint32_t>("count", Area::retained, ""), 0, 0));
    TagSpec text = tag_spec<bool>("label", Area::input, "");
    text.type = TagType::STRING;
    text.length = 20;
    image.add(text);
    image.seal();
  }
  CheckedOrder check(const std::string& body) const { return check_tag_order(image, parse_body(body, 1000)); }
  std::string refusal(const std::string& body, std::uint32_t code) const {
    const CheckedOrder order = check(body);
    CHECK_MESSAGE(order.refusal == code, body);
    return order.problem;
  }
  Image image;
};

Reply done(Slot value, bool changed) {
  Reply reply;
  reply.value = value;
  reply.changed = changed;
  return reply;
}

}  // namespace

TEST_CASE("tag order when right then has verb, tag and value for the scan [IMG-3]") {
  const Tags tags;
  const CheckedOrder force = tags.check("force conveyor on");
  CHECK(force.refusal == 0);
  CHECK(force.request.verb == Verb::force);
  CHECK(force.request.tag == 2);
  CHECK(force.request.value == 1);
  CHECK(tags.check("force offset -5").request.value == to_slot<std::int16_t>(-5));
  CHECK(tags.check("unforce conveyor").request.verb == Verb::unforce);
  CHECK(tags.check("unforce all").request.verb == Verb::unforce_all);
  CHECK(tags.check("set press_time 800ms").request.value == 800'000'000);
  CHECK(tags.check("set count 4294967295").refusal == 0);
  CHECK(tags.check("tags").request.tag == 0);
  CHECK(tags.check("tags conveyor").request.value == 1);
  CHECK(tags.check("tags after conveyor").request.tag == 3);
}

TEST_CASE("tag order when it cannot be then is refused with what to do instead [IMG-3, REQ-5]") {
  const Tags tags;
  CHECK(tags.refusal("force convoyer 1", code::unknown_tag) ==
        "there is no tag convoyer; did you mean \"conveyor\"?");
  CHECK(tags.refusal("force conveyor 2", code::value_invalid) ==
        "conveyor: 2 is no BOOL value; say true or false, 1 or 0, on or off");
  CHECK(tags.refusal("force offset 40000", code::value_invalid).ends_with("-32768..32767"));
  CHECK(tags.refusal("force label x", code::not_forceable) == "label is a STRING, which cannot be forced");
  CHECK(tags.refusal("force press_time 1s", code::not_forceable) ==
        "press_time is a parameter: inputs and outputs are forced; it can be set");
  CHECK(tags.refusal("force count 1", code::not_forceable).starts_with("count is a retained tag"));
  CHECK(tags.refusal("set speed 5", code::not_writable) ==
        "speed is not declared writable in the configuration");
  CHECK(tags.refusal("set conveyor 1", code::not_writable) ==
        "conveyor is an output tag: it can be forced, not set");
  CHECK(tags.refusal("set press_time 6s", code::value_invalid) == "press_time: 6s is out of range 100ms..5s");
  CHECK(tags.refusal("set press_time 800", code::value_invalid).ends_with("such as 800ms"));
  CHECK(tags.refusal("set count -1", code::value_invalid).ends_with("0..4294967295"));
  CHECK(tags.refusal("get press_tim", code::unknown_tag).ends_with("\"press_time\"?"));
  for (const char* body : {"force", "force conveyor", "force conveyor 1 2", "unforce", "unforce a b",
                           "set count", "tags a b", "tags after", "tags a b c", "get", "get a b"})
    CHECK_MESSAGE(tags.check(body).refusal != 0, body);
}

TEST_CASE("changes when the scan carried them out then are kept and each is a line for the log [IMG-3]") {
  const Tags tags;
  TagChanges changes;
  const auto take = [&](const char* body, const Reply& reply) {
    return take_change(tags.image, tags.check(body).request, reply, changes);
  };
  using Lines = std::vector<std::string>;
  CHECK(take("force conveyor 1", done(0, true)) == Lines{"tag conveyor forced to true"});
  CHECK(take("force conveyor 1", done(0, false)).empty());
  CHECK(take("force offset -5", done(0, true)) == Lines{"tag offset forced to -5"});
  CHECK(take("set press_time 800ms", done(300'000'000, true)) ==
        Lines{"tag press_time set to 800ms (was 300ms)"});
  CHECK(changes.forced.size() == 2);
  CHECK(changes.set.at(3) == 800'000'000);
  Reply refused = done(0, true);
  refused.outcome = Outcome::refused;
  CHECK(take("unforce offset", refused).empty());
  CHECK(take("unforce offset", done(1, true)) == Lines{"tag offset unforced"});
  CHECK(take("unforce all", done(1, true)) == Lines{"tag conveyor unforced"});
  CHECK(changes.forced.empty());
}

TEST_CASE("answer when an output is forced outside RUNNING then says that it stays safe [IMG-3]") {
  const Tags tags;
  Reply reply = done(0, true);
  const Request request = tags.check("force conveyor 1").request;
  CHECK(tag_answer(tags.image, request, reply, {}) ==
        "tag=conveyor forced=true note=the output stays safe until the station runs");
  reply.state = StationState::RUNNING;
  CHECK(tag_answer(tags.image, request, reply, {}) == "tag=conveyor forced=true");
}

TEST_CASE("tags when they do not fit into one body then each is told once, in pieces [IMG-3, IMG-2]") {
  Tags tags;
  const TagChanges changes{.set = {}, .forced = {{1, to_slot<std::int16_t>(-5)}, {2, 1}}};
  const BlockLayout layout{10, 7};  // the STRING of 20 bytes has four slots
  std::vector<std::byte> bytes(layout.size_bytes());
  const BlockView block{bytes.data(), layout};
  for (Quality& quality : block.qualities()) quality = Quality::GOOD;
  block.qualities()[1] = Quality::FORCED;
  block.slots()[1] = to_slot<std::int16_t>(-5);
  block.slots()[3] = 300'000'000;
  const ConstBlockView copy{bytes.data(), layout};
  const std::string whole = tags_answer(tags.image, tags.check("tags").request, copy, changes, 8000);
  CHECK(whole.find("tag=offset value=-5 quality=FORCED area=input type=INT forced=-5\n") !=
        std::string::npos);
  CHECK(whole.find("tag=conveyor value=false quality=GOOD area=output type=BOOL forced=true\n") !=
        std::string::npos);
  CHECK(whole.find("tag=press_time value=300ms quality=GOOD area=internal type=TIME writable=true "
                   "range=100ms..5s unit=t\n") != std::string::npos);
  std::string pieces, last, request = "tags";
  for (int n = 0; n < 7 && !request.empty(); ++n) {
    const std::string text = tags_answer(tags.image, tags.check(request).request, copy, changes, 256);
    CHECK(text.size() <= 256);
    const std::size_t next = text.find("\nnext=");
    pieces += (pieces.empty() ? "" : "\n") + text.substr(0, next);
    request = next == std::string::npos ? "" : "tags after " + text.substr(next + 6);
  }
  CHECK(pieces == whole);
  CHECK(tags_answer(tags.image, tags.check("tags offset").request, copy, changes, 256).find('\n') ==
        std::string::npos);
}

}  // namespace stationd::bus

// Forced inputs and outputs, and tags that an operator sets: what each scan sees and commits.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <random>

#include "scan/links.hpp"
#include "tests/scan_fixture.hpp"

namespace stationd {
namespace {

using test::kMs;
using test::kPeriodNs;
using test::StationRig;

TagIndex tag_of(const StationRig& rig, const char* name) { return *rig.station->image().find(name); }

Reply order(StationRig& rig, Verb verb, TagIndex tag, Slot value = 0) {
  Request request;
  request.token = 9;
  request.order = ++rig.order;
  request.verb = verb;
  request.tag = tag;
  request.value = value;
  rig.station->port().requests.push(request);
  while (rig.station->service_one()) {
  }
  return rig.reply();
}

Reply force(StationRig& rig, const char* name, Slot value) {
  return order(rig, Verb::force, tag_of(rig, name), value);
}

enum OutputSlot : std::uint8_t { valve, speed, gripper };

}  // namespace

TEST_CASE("input when forced then is its value, FORCED and good, whatever its source says [IMG-3, IMG-2]") {
  StationRig rig;
  rig.feed_device(false, 4);
  rig.scan();
  REQUIRE(force(rig, "part", 1).changed);
  rig.scan();
  CHECK(rig.program->part.get());
  CHECK(rig.program->part.quality() == Quality::FORCED);
  CHECK(rig.program->part.good());
  CHECK(rig.program->position.quality() == Quality::GOOD);
  rig.feed_device(false, 5, Quality::BAD);
  rig.scan();
  CHECK(rig.program->part.get());
  CHECK(rig.program->part.quality() == Quality::FORCED);
  CHECK(rig.program->position.quality() == Quality::BAD);
}

TEST_CASE("input when never seen then can be forced, and let go is BAD as before [IMG-3]") {
  StationRig rig;
  rig.scan();
  force(rig, "position", to_slot<std::int32_t>(-7));
  rig.scan();
  CHECK(rig.program->position.get() == -7);
  CHECK(rig.program->position.good());
  CHECK(order(rig, Verb::unforce, tag_of(rig, "position")).changed);
  rig.scan();
  CHECK(rig.program->position.get() == 0);
  CHECK(rig.program->position.quality() == Quality::BAD);
}

TEST_CASE(
    "input when let go then has its source's newest value in the next scan, nothing new needed [IMG-3]") {
  StationRig rig;
  rig.feed_device(true, 4);
  rig.scan();
  force(rig, "part", 0);
  rig.scan();
  rig.feed_device(true, 8);
  force(rig, "position", to_slot<std::int32_t>(99));
  rig.scan();
  REQUIRE_FALSE(rig.program->part.get());
  REQUIRE(rig.program->position.get() == 99);
  CHECK(order(rig, Verb::unforce_all, 0).value == 2);
  rig.scan();
  CHECK(rig.program->part.get());
  CHECK(rig.program->position.get() == 8);
  CHECK(rig.program->part.quality() == Quality::GOOD);
  for (int i = 0; i < 8; ++i) rig.scan();
  CHECK(rig.program->part.quality() == Quality::STALE);
}

TEST_CASE("output when forced then is committed so, and the program reads what it wrote [IMG-3]") {
  StationRig rig;
  rig.go(StationState::RUNNING);
  bool read_back = true;
  rig.program->on_execute = [&](Cycle& cycle) {
    if (cycle.scan() % 2 == 0) rig.program->speed = 40;
    read_back = rig.program->speed == 40;
  };
  rig.scan();
  rig.scan();
  force(rig, "speed", to_slot<std::int32_t>(11));
  rig.scan();
  CHECK(rig.driven_outputs()[speed] == 11);
  CHECK(*rig.station->image().quality(tag_of(rig, "speed")) == Quality::FORCED);
  CHECK(read_back);
  rig.scan();
  CHECK(read_back);
  CHECK(rig.driven_outputs()[speed] == 11);
  order(rig, Verb::unforce, tag_of(rig, "speed"));
  rig.scan();
  CHECK(rig.driven_outputs()[speed] == 40);
  CHECK(*rig.station->image().quality(tag_of(rig, "speed")) != Quality::FORCED);
}

TEST_CASE("output when forced outside RUNNING then stays safe, and is forced from Start on [IMG-3]") {
  for (const StationState state : {StationState::STOPPED, StationState::FAULT}) {
    StationRig rig;
    rig.go(state);
    force(rig, "valve", 1);
    force(rig, "speed", to_slot<std::int32_t>(11));
    force(rig, "gripper", 1);
    rig.scan();
    rig.scan();
    CHECK(rig.driven_outputs() == std::vector<Slot>{0, 3, 0});
    CHECK(*rig.station->image().quality(tag_of(rig, "valve")) != Quality::FORCED);
    CHECK(rig.status().forced == 3);
    rig.push(Verb::reset);
    rig.scan();
    CHECK(rig.driven_outputs() == std::vector<Slot>{0, 3, 0});
    rig.push(Verb::start);
    rig.scan();
    rig.scan();
    CHECK(rig.driven_outputs() == std::vector<Slot>{1, 11, 1});
  }
}

TEST_CASE("output when forced and the station leaves RUNNING then is safe in that scan [IMG-3]") {
  bool faulty = false;
  const std::vector<std::function<void(StationRig&)>> ways = {
      [](StationRig& rig) { rig.stop(StopMode::immediate); }, [&](StationRig&) { faulty = true; },
      [](StationRig& rig) { rig.station->fault(code::overrun, 0); },
      [](StationRig& rig) { rig.station->port().permit = false; }};
  for (const auto& leave : ways) {
    StationRig rig;
    faulty = false;
    rig.go(StationState::RUNNING);
    rig.program->on_execute = [&](Cycle& cycle) {
      rig.program->gripper = false;
      if (faulty) cycle.fault(9901);
    };
    force(rig, "valve", 1);
    force(rig, "gripper", 1);
    rig.scan();
    REQUIRE(rig.driven_outputs() == std::vector<Slot>{1, 3, 1});
    leave(rig);
    rig.scan();
    REQUIRE_FALSE(driven(rig.station->state()));
    // `valve` is safe; `gripper` has hold: it keeps what was committed last, which the device has.
    CHECK(rig.driven_outputs() == std::vector<Slot>{0, 3, 1});
    order(rig, Verb::unforce_all, 0);
    rig.scan();
    rig.scan();
    CHECK(rig.driven_outputs() == std::vector<Slot>{0, 3, 1});
  }
}

TEST_CASE("output with hold when let go in the scan of a Stop then keeps what the device has [IMG-3]") {
  StationRig rig;
  rig.go(StationState::RUNNING);
  force(rig, "gripper", 1);
  rig.scan();
  REQUIRE(rig.driven_outputs()[gripper] == 1);
  order(rig, Verb::unforce, tag_of(rig, "gripper"));
  rig.stop(StopMode::immediate);
  rig.scan();
  CHECK(rig.driven_outputs()[gripper] == 1);
  CHECK(rig.status().forced == 0);
}

TEST_CASE("forces when the table is full then one more is refused and the others stay [IMG-3]") {
  class Wide final : public Program {
   public:
    Wide() {
      for (int i = 0; i < 70; ++i)
        inputs.push_back(std::make_unique<In<std::uint16_t>>(*this, "in" + std::to_string(i), ""));
    }
    void execute(Cycle&) noexcept override {}
    std::vector<std::unique_ptr<In<std::uint16_t>>> inputs;
  };
  StationRig rig;
  auto made = std::make_unique<Wide>();
  Wide* program = made.get();
  rig.station = std::make_unique<Station>(StationRig::named("W"), std::move(made));
  rig.station->seal();
  for (TagIndex tag = 0; tag < Forces::kMost; ++tag) REQUIRE(order(rig, Verb::force, tag, tag + 1).changed);
  CHECK(order(rig, Verb::force, 64, 1).code == code::forces_full);
  CHECK(order(rig, Verb::force, 3, 77).changed);
  rig.scan();
  CHECK(program->inputs[3]->get() == 77);
  CHECK(program->inputs[63]->get() == 64);
  CHECK(program->inputs[64]->get() == 0);
  // All let go and as many others forced between the same two scans.
  CHECK(order(rig, Verb::unforce_all, 0).value == Forces::kMost);
  for (TagIndex tag = 6; tag < 6 + Forces::kMost; ++tag) REQUIRE(order(rig, Verb::force, tag, 5).changed);
  rig.scan();
  CHECK(rig.status().forced == Forces::kMost);
  CHECK(program->inputs[0]->quality() == Quality::BAD);
  CHECK(program->inputs[69]->get() == 5);
}

TEST_CASE("tag when the program owns it then is not forced, and set only if writable [IMG-3]") {
  StationRig rig;
  rig.scan();
  CHECK(force(rig, "code", 1).code == code::not_forceable);
  CHECK(force(rig, "limit", 1).code == code::not_forceable);
  CHECK(force(rig, "pieces", 1).code == code::not_forceable);
  CHECK(order(rig, Verb::set, tag_of(rig, "limit"), 9).code == code::not_writable);
  CHECK(order(rig, Verb::set, tag_of(rig, "valve"), 1).code == code::not_writable);
  CHECK(rig.program->limit == 5);
  TagSpec spec = rig.program->limit.spec();
  spec.type = TagType::STRING;
  spec.area = Area::input;
  CHECK_FALSE(forceable(spec));
}

TEST_CASE("tag when writable then has the set value in the next scan, retained ones are saved [IMG-3]") {
  StationRig rig;
  rig.station->image().spec(tag_of(rig, "limit")).writable = true;
  rig.station->image().spec(tag_of(rig, "pieces")).writable = true;
  rig.go(StationState::RUNNING);
  std::int32_t seen = 0;
  rig.program->on_execute = [&](Cycle&) { seen = rig.program->limit; };
  const Reply reply = order(rig, Verb::set, tag_of(rig, "limit"), 9);
  CHECK(reply.changed);
  CHECK(reply.value == 5);
  order(rig, Verb::set, tag_of(rig, "pieces"), 12);
  rig.scan();
  CHECK(seen == 9);
  RetainLink& retain = rig.station->retain();
  REQUIRE(retain.blocks.update());
  const ConstBlockView saved{retain.blocks.readable(), retain.tags.layout};
  CHECK(std::ranges::count(saved.slots(), Slot{12}) == 1);
  CHECK_FALSE(order(rig, Verb::set, tag_of(rig, "limit"), 9).changed);
}

TEST_CASE("forces and sets when they change then each is one event that names the tag [IMG-3]") {
  StationRig rig;
  rig.station->image().spec(tag_of(rig, "limit")).writable = true;
  rig.scan();
  rig.events();
  force(rig, "part", 1);
  force(rig, "part", 1);
  force(rig, "valve", 1);
  order(rig, Verb::unforce, tag_of(rig, "part"));
  order(rig, Verb::unforce, tag_of(rig, "part"));
  order(rig, Verb::set, tag_of(rig, "limit"), 6);
  order(rig, Verb::unforce_all, 0);
  std::vector<std::pair<std::uint32_t, std::int64_t>> seen;
  for (const Event& event : rig.events()) {
    CHECK(event.severity == Severity::info);
    seen.emplace_back(event.code, event.detail);
  }
  CHECK(seen ==
        std::vector<std::pair<std::uint32_t, std::int64_t>>{{code::tag_forced, tag_of(rig, "part")},
                                                            {code::tag_forced, tag_of(rig, "valve")},
                                                            {code::tag_unforced, tag_of(rig, "part")},
                                                            {code::tag_set, tag_of(rig, "limit")},
                                                            {code::tag_unforced, tag_of(rig, "valve")}});
}

TEST_CASE("image when copied then has every tag as the last scan left it [IMG-3]") {
  StationRig rig;
  rig.feed_device(true, 4);
  force(rig, "part", 0);
  rig.scan();
  CHECK(order(rig, Verb::tags, 0).outcome == Outcome::done);
  ImageCopy& copy = rig.station->image_copy();
  REQUIRE(copy.blocks.update());
  const ConstBlockView block{copy.blocks.readable(), copy.tags.layout};
  CHECK(block.slots().size() == rig.station->image().size());
  CHECK(block.slots()[tag_of(rig, "position")] == 4);
  CHECK(block.slots()[tag_of(rig, "part")] == 0);
  CHECK(block.qualities()[tag_of(rig, "part")] == Quality::FORCED);
  CHECK(block.header().scan == rig.number);
}

namespace {

/// What is to stand in the image, said in the plainest way.
struct Model {
  using Values = std::map<std::string, Slot>;
  Values inputs{{"part", 0}, {"position", 0}};  // as their source says
  Values program{{"valve", 0}, {"speed", 3}, {"gripper", 0}};
  Values committed = program;
  Values forces;

  void commit(bool is_driven) {
    if (!is_driven) {
      committed["valve"] = 0;
      committed["speed"] = 3;
      if (!was_driven) committed["gripper"] = program["gripper"];
      // A scan that faults commits what the program wrote, unless a force stood in the scan before.
      if (was_driven && !gripper_forced) committed["gripper"] = program["gripper"];
      program = committed;  // where it goes on at Start
    } else {
      committed = program;
      for (const auto& [tag, value] : forces)
        if (committed.contains(tag)) committed[tag] = value;
    }
    was_driven = is_driven;
    gripper_forced = is_driven && forces.contains("gripper");
  }
  std::vector<Slot> outputs() { return {committed["valve"], committed["speed"], committed["gripper"]}; }

  bool was_driven = false;
  bool gripper_forced = false;
};

/// A station and its model under the same random orders, field data and program.
class Against {
 public:
  Against() {
    rig.program->on_execute = [this](Cycle& cycle) { write(cycle); };
    rig.program->on_idle = [this](Cycle&) { rig.program->gripper = upto(1) != 0; };  // without effect
  }

  void operate() {
    const std::string& tag = tags[upto(4)];
    const Slot value = tag == "position" || tag == "speed" ? upto(90) : upto(1);
    const std::uint32_t choice = upto(31);
    if (choice < 6) {
      order(rig, Verb::force, tag_of(rig, tag.c_str()), value);
      model.forces[tag] = value;
    } else if (choice < 12) {
      order(rig, Verb::unforce, tag_of(rig, tag.c_str()));
      model.forces.erase(tag);
    } else if (choice == 12) {
      order(rig, Verb::unforce_all, 0);
      model.forces.clear();
    } else if (choice < 18) {
      order(rig, Verb::reset, 0);
      order(rig, Verb::start, 0);
    } else if (choice == 18) {
      rig.stop(StopMode::immediate);
    }
  }

  /// The device publishes, or does not; a BAD block has no values.
  void feed() {
    if (upto(3) == 0) silence = upto(12);
    if (silence > 0) {
      --silence;
      return;
    }
    const Quality quality = upto(3) == 0 ? Quality::BAD : Quality::GOOD;
    const Slot part = upto(1), position = upto(90);
    rig.feed_device(part != 0, static_cast<std::int32_t>(position), quality);
    fed_ns = rig.now_ns + kPeriodNs;
    fed = quality;
    if (quality == Quality::BAD) return;
    model.inputs["part"] = part;
    model.inputs["position"] = position;
  }

  std::uint32_t differences() {
    const std::int64_t age_ns = rig.now_ns - fed_ns;
    const Quality source = age_ns > 100 * kMs  ? Quality::BAD
                           : age_ns > 50 * kMs ? std::min(fed, Quality::STALE)
                                               : fed;
    model.commit(driven(rig.station->state()));
    std::uint32_t count = rig.driven_outputs() != model.outputs() ? 1U : 0U;
    for (const std::string& name : {tags[0], tags[1]}) {
      const TagIndex tag = tag_of(rig, name.c_str());
      const bool forced = model.forces.contains(name);
      const Slot value = forced ? model.forces[name] : model.inputs[name];
      if (*rig.station->image().value(tag) != value) ++count;
      if (*rig.station->image().quality(tag) != (forced ? Quality::FORCED : source)) ++count;
    }
    if (rig.status().forced != model.forces.size()) ++count;
    rig.events();
    return count;
  }

  std::uint32_t upto(std::uint32_t most) { return static_cast<std::uint32_t>(random() % (most + 1)); }

  StationRig rig;
  Model model;

 private:
  void write(Cycle& cycle) {
    if (upto(1) == 0) rig.program->valve = (model.program["valve"] = upto(1)) != 0;
    if (upto(2) == 0) rig.program->gripper = (model.program["gripper"] = upto(1)) != 0;
    if (upto(2) == 0) rig.program->speed = static_cast<std::int32_t>(model.program["speed"] = upto(90));
    if (upto(19) == 0) cycle.fault(9901);
  }

  const std::vector<std::string> tags = {"part", "position", "valve", "speed", "gripper"};
  std::mt19937 random{61};
  std::uint32_t silence = 0;
  std::int64_t fed_ns = -1000 * kMs;
  Quality fed = Quality::BAD;
};

}  // namespace

TEST_CASE("random forces, sources, programs and states when run then agree with a plain model [IMG-3]") {
  Against both;
  std::uint32_t differences = 0, driven_scans = 0, forced_scans = 0;
  constexpr std::uint32_t kScans = 20'000;
  for (std::uint32_t n = 0; n < kScans; ++n) {
    both.operate();
    both.feed();
    both.rig.scan_without_service();
    differences += both.differences();
    driven_scans += driven(both.rig.station->state()) ? 1U : 0U;
    forced_scans += both.model.forces.empty() ? 0U : 1U;
  }
  CHECK(differences == 0);
  CHECK(driven_scans > kScans / 5);
  CHECK(driven_scans < kScans / 5 * 4);
  CHECK(forced_scans > kScans / 5);
}

}  // namespace stationd

// The programs' building blocks with plain values: announcements, arm, types of piece; the list of
// programs; codes.
#include <doctest/doctest.h>

#include <algorithm>

#include "programs/announcements.hpp"
#include "programs/arm.hpp"
#include "programs/piece_types.hpp"
#include "programs/programs.hpp"
#include "scan/codes.hpp"
#include "scan/error.hpp"
#include "scan/station.hpp"

using namespace stationd;
using namespace stationd::programs;
using Heard = Announcements::Heard;

namespace {

Announcement piece(std::uint32_t epoch, std::uint32_t seq, std::uint32_t code) {
  return {epoch, seq, code, false};
}

/// An arm that follows its outputs at once.
struct ArmRig {
  ArmInputs in{true, false, true, false, false, kArmHome};
  ArmPermits may;
  Arm arm;
  std::int64_t clock_ns = 0;
  std::int64_t timeout_ns = 1'000'000'000;

  ArmRig() {
    arm.restart(in, {}, 0);
    run(4);
  }
  std::uint32_t scan() {
    clock_ns += 10'000'000;
    const std::uint32_t wrong = arm.run(in, may, clock_ns, timeout_ns);
    const ArmOutputs& out = arm.outputs();
    in.up = !out.down;
    in.down = out.down;
    in.gripper_open = !out.close;
    in.gripper_closed = out.close;
    const bool between = out.enable && in.position != 0 && in.position != out.target;
    if (out.enable) in.position = between ? std::uint16_t{0} : out.target;
    may.recorded = arm.asks() != Record::none;
    return wrong;
  }
  std::uint32_t run(int scans) {
    std::uint32_t wrong = 0;
    for (int i = 0; i < scans && wrong == 0; ++i) wrong = scan();
    return wrong;
  }
  std::uint32_t run_to(ArmStep step) {
    std::uint32_t wrong = 0;
    for (int i = 0; i < 1'000 && wrong == 0 && arm.step() != step; ++i) wrong = scan();
    return wrong;
  }
  void fetch_bearing() {
    may.errand = {Kind::bearing, 2, 4, kArmOverPallet};
    may.lower = may.pick = true;
    run_to(ArmStep::grip);
    scan();
    in.part = true;
    run_to(ArmStep::hold);
  }
};

ProgramOptions options_for(const std::string& station) {
  ProgramOptions options;
  options.station = station;
  options.recipes = {
      {101,
       "one",
       {{"base", 1}, {"bearing", 1}, {"shaft", 2}, {"lid", 1}, {"press_time", 300'000'000}, {"shelf", 2}}}};
  return options;
}

}  // namespace

TEST_CASE("Announcement repeated is acted on once (cell.md, once per STATION, EPOCH, SEQ)") {
  Announcements queue;
  CHECK(queue.hear_set(piece(1, 1, 101), 0) == Heard::queued);
  CHECK(queue.hear_set(piece(1, 1, 101), 0) == Heard::nothing);
  CHECK(queue.size() == 1);
}

TEST_CASE("Announcement without a code is none") {
  Announcements queue;
  CHECK(queue.hear_set(piece(0, 0, 0), 0) == Heard::nothing);
  CHECK(queue.front() == nullptr);
}

TEST_CASE("Announcement after a gap in SEQ is queued and reported") {
  Announcements queue;
  queue.hear_set(piece(1, 1, 101), 0);
  CHECK(queue.hear_set(piece(1, 3, 103), 0) == Heard::gap);
  CHECK(queue.size() == 2);
}

TEST_CASE("Announcement of a new EPOCH with the code of the newest, whose pallet is not here, replaces it") {
  Announcements queue;
  queue.hear_set(piece(1, 1, 101), 0);
  queue.hear_set(piece(1, 2, 102), 0);
  CHECK(queue.hear_set(piece(2, 1, 102), 1) == Heard::queued);
  CHECK(queue.size() == 2);
  CHECK(queue.content().entries[1] == piece(2, 1, 102));
}

TEST_CASE("Announcement of a new EPOCH leaves those whose pallets are here, let go, or of another code") {
  Announcements queue;
  queue.hear_set(piece(1, 1, 101), 0);
  CHECK(queue.hear_set(piece(2, 1, 101), 1) == Heard::queued);
  queue.hear_end(piece(2, 1, 101), false);
  CHECK(queue.hear_set(piece(3, 1, 101), 0) == Heard::queued);
  CHECK(queue.size() == 3);
  queue.pop_front();
  CHECK(queue.hear_set(piece(4, 1, 102), 0) == Heard::queued);
  CHECK(queue.size() == 3);
}

TEST_CASE("Announcement beyond three drops the oldest") {
  Announcements queue;
  for (std::uint32_t seq = 1; seq <= 3; ++seq) queue.hear_set(piece(1, seq, 101), 0);
  CHECK(queue.hear_set(piece(1, 4, 102), 0) == Heard::overflow);
  CHECK(queue.size() == 3);
  CHECK(queue.front()->seq == 2);
}

TEST_CASE("End with an error takes the announcement back; one without marks all before it as ended") {
  Announcements queue;
  for (std::uint32_t seq = 1; seq <= 3; ++seq) queue.hear_set(piece(1, seq, 101), 0);
  queue.hear_end(piece(1, 2, 101), true);
  CHECK(queue.size() == 2);
  queue.hear_end(piece(1, 3, 101), false);
  CHECK(queue.ended_count() == 2);
}

TEST_CASE("Pieces of a writer that does not number them are told apart by their code (PV-5)") {
  Announcements queue;
  CHECK(queue.hear_set(piece(0, 0, 101), 0) == Heard::queued);
  CHECK(queue.hear_set(piece(0, 0, 101), 0) == Heard::nothing);
  CHECK(queue.hear_set(piece(0, 0, 102), 0) == Heard::queued);
  queue.hear_end(piece(0, 0, 101), false);
  CHECK(queue.ended_count() == 1);
  CHECK(queue.size() == 2);
}

TEST_CASE("Queue skipped to a code drops what stands before it, or nothing") {
  Announcements queue;
  queue.hear_set(piece(1, 1, 101), 0);
  queue.hear_set(piece(1, 2, 102), 0);
  CHECK(queue.skip_to(999) == nullptr);
  CHECK(queue.size() == 2);
  CHECK(queue.skip_to(102)->seq == 2);
  CHECK(queue.size() == 1);
}

TEST_CASE("Queue restored with an impossible size is empty") {
  Announcements queue;
  Announcements::Content content;
  content.size = 4;
  queue.restore(content);
  CHECK(queue.front() == nullptr);
}

TEST_CASE("Arm asks for a record before it is lowered to fetch (IMG-5)") {
  ArmRig rig;
  rig.may.errand = {Kind::bearing, 1, 3, kArmOverPallet};
  rig.may.lower = rig.may.pick = true;
  rig.run_to(ArmStep::record_pick);
  for (int i = 0; i < 20; ++i) {
    rig.may.recorded = false;
    rig.arm.run(rig.in, rig.may, rig.clock_ns, rig.timeout_ns);
  }
  CHECK(rig.arm.step() == ArmStep::record_pick);
  CHECK(rig.arm.asks() == Record::pick);
  CHECK_FALSE(rig.arm.outputs().down);
}

TEST_CASE("Arm that holds a part fetched ahead waits for its pallet without a time-out") {
  ArmRig rig;
  rig.fetch_bearing();
  CHECK(rig.run(500) == 0);
  CHECK(rig.arm.step() == ArmStep::hold);
  CHECK(rig.in.position == kArmHome);
}

TEST_CASE("Arm that holds another part than the piece in position takes is a fault") {
  ArmRig rig;
  rig.fetch_bearing();
  rig.may.needed = true;
  rig.may.errand.variant = 1;
  CHECK(rig.run(5) == code::gripper_wrong_part);
}

TEST_CASE("Arm whose part is gone is a fault") {
  ArmRig rig;
  rig.fetch_bearing();
  rig.in.part = false;
  CHECK(rig.scan() == code::part_lost);
}

TEST_CASE("Arm is not lowered over a place that is not free, and says so after the time-out") {
  ArmRig rig;
  rig.fetch_bearing();
  rig.may.needed = rig.may.place = true;
  rig.run_to(ArmStep::wait_target);
  CHECK(rig.in.position == kArmOverPallet);
  CHECK(rig.run(200) == code::place_taken);
  CHECK_FALSE(rig.arm.outputs().down);
}

TEST_CASE("Arm does not move sideways while both its end switches are on") {
  ArmRig rig;
  rig.may.errand = {Kind::bearing, 1, 3, kArmOverPallet};
  rig.run_to(ArmStep::to_source);
  rig.in.down = true;
  rig.arm.run(rig.in, rig.may, rig.clock_ns, rig.timeout_ns);
  CHECK_FALSE(rig.arm.outputs().enable);
}

TEST_CASE("Arm position that jumps is a fault, unless the inputs were not to be seen") {
  ArmRig rig;
  rig.in.position = 4;
  CHECK(rig.scan() == code::arm_astray);
  ArmRig other;
  other.in.position = 4;
  other.arm.look_away();
  CHECK(other.scan() == 0);
}

TEST_CASE("Arm restarted with a part but no record asks what it is (IMG-5)") {
  ArmRig rig;
  rig.in.part = true;
  rig.arm.restart(rig.in, {}, rig.clock_ns);
  CHECK(rig.scan() == code::gripper_unknown_part);
  CHECK(rig.arm.outputs().close);
}

TEST_CASE("Types of piece refuse a missing value, code 0, a code given twice and too many (CFG-2)") {
  constexpr std::array kinds = {Kind::lid};
  const Recipe good{101, "one", {{"lid", 1}, {"press_time", 300'000'000}}};
  CHECK(PieceTypes(std::vector<Recipe>{good}, kinds, true).find(101)->press_ns == 300'000'000);
  CHECK(PieceTypes(std::vector<Recipe>{good}, kinds, true).find(102) == nullptr);
  CHECK_THROWS_AS(PieceTypes({}, kinds, true), SetupError);
  CHECK_THROWS_AS(PieceTypes(std::vector<Recipe>{good, good}, kinds, true), SetupError);
  CHECK_THROWS_AS(PieceTypes(std::vector<Recipe>{{0, "zero", good.values}}, kinds, true), SetupError);
  CHECK_THROWS_AS(PieceTypes(std::vector<Recipe>{{102, "two", {{"lid", 1}}}}, kinds, true), SetupError);
  CHECK_THROWS_AS(PieceTypes(std::vector<Recipe>{{102, "two", {{"lid", 3}}}}, kinds, false), SetupError);
  std::vector<Recipe> many(33, good);
  for (std::uint32_t i = 0; i < 33; ++i) many[i].code = i + 1;
  CHECK_THROWS_AS(PieceTypes(many, kinds, true), SetupError);
}

TEST_CASE("Program of an unknown kind is refused by a message that names the known ones") {
  std::string message;
  try {
    make_program("welder", options_for("welder"));
  } catch (const SetupError& error) {
    message = error.what();
  }
  for (const std::string& name : program_names()) CHECK(message.find(name) != std::string::npos);
}

TEST_CASE("Each program of the list can be made") {
  for (const std::string& name : program_names()) CHECK(make_program(name, options_for(name)) != nullptr);
}

TEST_CASE(
    "Each code has a name, a cause and a remedy, and a question has an answer that ends in reset and Start") {
  for (const CodeInfo& info : all_codes()) {
    INFO("code ", info.code);
    CHECK_FALSE(info.name.empty());
    CHECK_FALSE(info.cause.empty());
    CHECK_FALSE(info.remedy.empty());
    const bool answered = info.remedy.find("eset and Start") != std::string_view::npos;
    CHECK((!is_question(info) || answered));
  }
}

TEST_CASE("Example fills its tank between the marks, and a pump that runs dry is a fault") {
  StationOptions station_options;
  station_options.name = "tank";
  Station station(station_options, make_program("example", options_for("tank")));
  InputLink& inputs =
      station.add_device_inputs("io", {"level_low", "level_high"}, 1'000'000'000, 2'000'000'000);
  station.seal();
  Request start;
  start.order = 1;
  station.port().requests.push(start);
  std::uint64_t scan = 0;
  const auto run = [&](bool low, bool high, std::int64_t period_ns) {
    ++scan;
    const std::int64_t now_ns = static_cast<std::int64_t>(scan) * period_ns;
    const BlockView block{inputs.blocks.writable(), inputs.tags.layout};
    block.slots()[0] = low;
    block.slots()[1] = high;
    std::ranges::fill(block.qualities(), Quality::GOOD);
    block.header().time_ns = now_ns;
    block.header().count = scan;
    block.header().quality = Quality::GOOD;
    inputs.blocks.publish();
    station.begin(now_ns, scan, 0);
    station.latch();
    station.execute();
    station.commit();
    station.publish(0);
    station.service_one();
    return *station.image().value(*station.image().find("pump")) != 0;
  };
  constexpr std::int64_t kPeriod_ns = 10'000'000;
  run(true, false, kPeriod_ns);
  CHECK(run(true, false, kPeriod_ns));
  CHECK(run(false, false, kPeriod_ns));
  CHECK_FALSE(run(false, true, kPeriod_ns));
  CHECK_FALSE(run(false, false, kPeriod_ns));
  CHECK(run(true, false, kPeriod_ns));
  CHECK_FALSE(run(true, false, 100'000'000'000));
  CHECK(station.active_fault() == code::example_fill_timeout);
}

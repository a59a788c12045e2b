// The supervisor's model: start order, intents, pieces, events (issue item "Supervisor"; ASE 2; REQ 4).
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "supervisor/answers.hpp"
#include "supervisor/model.hpp"

using namespace stationd;
using namespace stationd::supervisor;

namespace {

constexpr std::int64_t ms = 1'000'000;

ModelOptions options() {
  ModelOptions options;
  options.stations = {"storage", "sealer", "robot"};
  return options;
}

bus::Status status(const std::string& station, StationState state, std::uint32_t cause = 0,
                   std::uint32_t epoch = 1) {
  bus::Status status;
  status.STATION = station;
  status.CONTROLLER = "controller1";
  status.STATE = static_cast<std::uint32_t>(state);
  status.STOP_CAUSE = cause;
  status.EPOCH = epoch;
  return status;
}

bus::End end(const std::string& station, std::uint32_t epoch, std::uint32_t seq, bool error = false) {
  bus::End end;
  end.STATION = station;
  end.CODE = 101;
  end.EPOCH = epoch;
  end.SEQ = seq;
  end.ERROR = error;
  return end;
}

bus::Gse gse(const std::string& station, std::uint32_t epoch, std::uint32_t seq) {
  bus::Gse gse;
  gse.STATION = station;
  gse.EPOCH = epoch;
  gse.SEQ = seq;
  gse.STATUS = 1101;
  gse.SEVERITY = 1;
  gse.ACTIVE = true;
  return gse;
}

bus::MsgReq order(const std::string& station, const std::string& body, bus::Order kind) {
  return {station, body, kind};
}

std::vector<std::string> started(const std::vector<Action>& actions) {
  std::vector<std::string> names;
  for (const Action& action : actions)
    if (action.kind == Action::Kind::start) names.push_back(action.station);
  return names;
}

using Names = std::vector<std::string>;

/// A model whose stations all stand in STOPPED, never started, at time 0.
Model with_all_seen(const SavedState& saved = {}) {
  Model model(options(), saved);
  for (const std::string& name : options().stations) model.on_status(status(name, StationState::STOPPED), 0);
  return model;
}

void run(Model& model, const std::string& station, std::int64_t now_ns, std::uint32_t epoch = 1) {
  model.on_status(status(station, StationState::RUNNING, 0, epoch), now_ns);
}

}  // namespace

TEST_SUITE_BEGIN("supervisor start rules");

TEST_CASE("nothing is started before it is seen") {
  Model model(options());
  CHECK(model.tick(0).empty());
  CHECK(model.tick(10'000 * ms).empty());
}

TEST_CASE("stations start in the configured order, each when the one before runs") {
  Model model = with_all_seen();
  CHECK(started(model.tick(1 * ms)) == Names{"storage"});
  CHECK(started(model.tick(2 * ms)).empty());
  run(model, "storage", 3 * ms);
  CHECK(started(model.tick(4 * ms)) == Names{"sealer"});
  run(model, "sealer", 5 * ms);
  CHECK(started(model.tick(6 * ms)) == Names{"robot"});
  run(model, "robot", 7 * ms);
  CHECK(started(model.tick(600 * ms)).empty());
}

TEST_CASE("Start is repeated every start_repeat until Status confirms RUNNING") {
  Model model = with_all_seen();
  CHECK(started(model.tick(0)) == Names{"storage"});
  CHECK(started(model.tick(499 * ms)).empty());
  CHECK(started(model.tick(500 * ms)) == Names{"storage"});
  CHECK(started(model.tick(999 * ms)).empty());
  model.on_status(status("storage", StationState::STOPPED), 999 * ms);
  CHECK(started(model.tick(1000 * ms)) == Names{"storage"});
  run(model, "storage", 1001 * ms);
  CHECK(started(model.tick(1500 * ms)).empty());
}

TEST_CASE("a station that is away is not ordered and holds up the one behind it") {
  Model model = with_all_seen();
  CHECK(started(model.tick(1001 * ms)).empty());
  model.on_status(status("sealer", StationState::STOPPED), 1002 * ms);
  CHECK(started(model.tick(1003 * ms)).empty());
  CHECK(model.away(*model.station("storage"), 1003 * ms));
  CHECK_FALSE(model.away(*model.station("sealer"), 1003 * ms));
}

TEST_CASE("what an operator stopped is not started, by Status alone") {
  Model model(options());
  model.on_status(status("storage", StationState::STOPPED, 1), 0);
  CHECK(started(model.tick(1 * ms)).empty());
  CHECK(model.station("storage")->intent == Intent::stopped);
}

TEST_CASE("an operator's Stop seen outlives a restart of the daemon") {
  Model model = with_all_seen();
  run(model, "storage", 1 * ms);
  model.on_stop(order("storage", "mode=end_of_piece from=stationctl-1", bus::Order::STOP), 2, 2 * ms);
  run(model, "storage", 3 * ms);  // sent before the Stop came to it
  CHECK(model.station("storage")->intent == Intent::stopped);
  model.on_status(status("storage", StationState::STOPPING), 4 * ms);
  model.on_status(status("storage", StationState::STOPPED, 0, 2), 500 * ms);  // killed while stopping
  CHECK(started(model.tick(501 * ms)).empty());
  CHECK(started(model.tick(5'000 * ms)).empty());
}

TEST_CASE("an operator's Start sets the intent to run again") {
  Model model(options());
  model.on_status(status("storage", StationState::STOPPED, 1), 0);
  model.on_start(order("storage", "from=stationctl-1", bus::Order::START), 1);
  CHECK(model.station("storage")->intent == Intent::run);
  model.on_status(status("storage", StationState::STOPPED, 1), 2 * ms);  // not carried out yet
  CHECK(model.station("storage")->intent == Intent::run);
  CHECK(started(model.tick(3 * ms)).empty());  // the operator's order is not ours to repeat
  run(model, "storage", 4 * ms);
  model.on_status(status("storage", StationState::STOPPED, 0, 2), 500 * ms);
  CHECK(started(model.tick(501 * ms)) == Names{"storage"});
}

TEST_CASE("our own Start on the bus says nothing of an operator") {
  Model model(options());
  model.on_status(status("storage", StationState::STOPPED, 1), 0);
  model.on_start(order("storage", "from=supervisor id=4", bus::Order::START), 1);
  CHECK(model.station("storage")->intent == Intent::stopped);
}

TEST_CASE("a Start that was received before a Stop is void though it is handed out after it") {
  Model model(options());
  run(model, "storage", 0);
  model.on_stop(order("storage", "", bus::Order::STOP), 8, 1 * ms);
  model.on_start(order("storage", "from=stationctl-1", bus::Order::START), 7);
  CHECK(model.station("storage")->intent == Intent::stopped);
  model.on_start(order("storage", "from=stationctl-1", bus::Order::START), 9);
  CHECK(model.station("storage")->intent == Intent::run);
}

TEST_CASE("what faulted is not started, not after reset, not after a restart") {
  Model model = with_all_seen();
  run(model, "storage", 1 * ms);
  model.on_status(status("storage", StationState::FAULT), 2 * ms);
  CHECK(started(model.tick(3 * ms)) == Names{});
  CHECK(model.station("storage")->intent == Intent::faulted);
  model.on_status(status("storage", StationState::STOPPED, 2), 4 * ms);
  CHECK(started(model.tick(600 * ms)).empty());
  model.on_status(status("storage", StationState::STOPPED, 0, 2), 700 * ms);
  CHECK(started(model.tick(701 * ms)).empty());
  run(model, "storage", 800 * ms, 2);  // an operator started it
  CHECK(model.station("storage")->intent == Intent::run);
}

TEST_CASE("a Start at a station in FAULT does not change the intent") {
  Model model(options());
  model.on_status(status("storage", StationState::FAULT), 0);
  model.on_start(order("storage", "", bus::Order::START), 1);
  CHECK(model.station("storage")->intent == Intent::faulted);
}

TEST_CASE("what came back by itself after a restart of its daemon is started at once") {
  Model model = with_all_seen();
  for (const std::string& name : options().stations) run(model, name, 1 * ms);
  CHECK(model.tick(2 * ms).empty());
  model.on_status(status("sealer", StationState::STOPPED, 0, 2), 900 * ms);
  run(model, "storage", 900 * ms);
  CHECK(started(model.tick(901 * ms)) == Names{"sealer"});
  CHECK(model.station("sealer")->restarts == 1);
}

TEST_CASE(
    "a station that came back waits for a predecessor that is being started, not for one that is held") {
  Model model = with_all_seen();
  for (const std::string& name : options().stations) run(model, name, 1 * ms);
  model.on_status(status("storage", StationState::STOPPED, 0, 2), 10 * ms);
  model.on_status(status("sealer", StationState::STOPPED, 0, 2), 10 * ms);
  CHECK(started(model.tick(11 * ms)) == Names{"storage"});
  model.on_stop(order("storage", "", bus::Order::STOP), 2, 12 * ms);
  CHECK(started(model.tick(13 * ms)) == Names{"sealer"});
}

TEST_CASE("a saved intent holds over the supervisor's own restart") {
  Model before = with_all_seen();
  before.on_stop(order("storage", "from=stationctl-9", bus::Order::STOP), 2, 1 * ms);
  const std::optional<SavedState> saved = decode(encode(before.saved()));
  REQUIRE(saved);
  Model after = with_all_seen(*saved);
  CHECK(started(after.tick(1 * ms)).empty());
  CHECK(after.station("storage")->intent == Intent::stopped);
}

TEST_CASE("a Stop that our Start crossed is repeated until it holds") {
  ModelOptions alone = options();
  alone.stations = {"storage"};
  Model model(alone);
  model.on_status(status("storage", StationState::STOPPED), 0);
  CHECK(started(model.tick(0)) == Names{"storage"});
  model.on_stop(order("storage", "mode=immediate from=stationctl-1", bus::Order::STOP), 2, 1 * ms);
  model.on_status(status("storage", StationState::STOPPED, 1), 2 * ms);
  run(model, "storage", 3 * ms);  // our Start came after the Stop
  CHECK(model.station("storage")->intent == Intent::stopped);
  CHECK(model.tick(4 * ms).empty());
  run(model, "storage", 501 * ms);
  const std::vector<Action> actions = model.tick(502 * ms);
  REQUIRE(actions.size() == 1);
  CHECK(actions[0].kind == Action::Kind::repeat_stop);
  CHECK(actions[0].body == "mode=immediate");
  model.on_status(status("storage", StationState::STOPPED, 1), 600 * ms);
  CHECK(model.tick(5'000 * ms).empty());
}

TEST_CASE("an observer orders nothing but knows the intents") {
  Model model = with_all_seen();
  model.set_role(Role::observing);
  CHECK(model.tick(1 * ms).empty());
  model.on_stop(order("storage", "", bus::Order::STOP), 2, 2 * ms);
  CHECK(model.station("storage")->intent == Intent::stopped);
}

TEST_CASE("a controller that leaves the bus is noted") {
  Model model(options());
  model.on_liveliness("Status", 2);
  model.on_liveliness("Set", 0);
  CHECK(model.take_notes().empty());
  model.on_liveliness("Status", 1);
  CHECK(model.take_notes() == Names{"a controller has left the bus; 1 is there"});
}

TEST_CASE("a station outside the start order is shown and never ordered") {
  Model model(options());
  model.on_status(status("painter", StationState::STOPPED), 0);
  CHECK(model.tick(1 * ms).empty());
  REQUIRE(model.station("painter") != nullptr);
  CHECK_FALSE(model.station("painter")->configured);
}

TEST_SUITE_END();

TEST_SUITE_BEGIN("supervisor pieces");

TEST_CASE("a piece counts once, however often its End is repeated") {
  Model model = with_all_seen();
  for (int i = 0; i < 5; ++i) model.on_end(end("storage", 1, 1), i * ms);
  for (int i = 0; i < 5; ++i) model.on_end(end("storage", 1, 2), i * ms);
  CHECK(model.pieces() == 2);
  CHECK(model.station("storage")->pieces.missed == 0);
}

TEST_CASE("the pieces of the cell are those of the first started, others are counted apart") {
  Model model = with_all_seen();
  model.on_end(end("robot", 1, 1), 0);
  CHECK(model.pieces() == 0);
  CHECK(model.station("robot")->pieces.counted == 1);
}

TEST_CASE("a gap in SEQ shows as pieces finished unseen") {
  Model model = with_all_seen();
  model.on_end(end("storage", 1, 1), 0);
  model.on_end(end("storage", 1, 4), 0);
  CHECK(model.station("storage")->pieces.counted == 2);
  CHECK(model.station("storage")->pieces.missed == 2);
  CHECK(model.pieces() == 4);
}

TEST_CASE("a new epoch begins at SEQ 1; an older epoch's End is not counted twice") {
  Model model = with_all_seen();
  model.on_end(end("storage", 1, 1), 0);
  model.on_end(end("storage", 2, 1), 0);
  model.on_end(end("storage", 1, 1), 0);
  CHECK(model.pieces() == 2);
  CHECK(model.station("storage")->pieces.missed == 0);
}

TEST_CASE("whoever joins a running station does not count what was before") {
  Model model(options());
  run(model, "storage", 0);
  model.on_end(end("storage", 3, 57), 0);
  CHECK(model.pieces() == 1);
  CHECK(model.station("storage")->pieces.missed == 0);
}

TEST_CASE("what the first End skips since the station was seen unstarted was missed") {
  Model model = with_all_seen();
  model.on_end(end("storage", 1, 3), 0);
  CHECK(model.pieces() == 3);
}

TEST_CASE("counts go on after a restart of the supervisor") {
  Model before = with_all_seen();
  before.on_end(end("storage", 1, 1), 0);
  before.on_end(end("storage", 1, 2, true), 0);
  const std::optional<SavedState> saved = decode(encode(before.saved()));
  REQUIRE(saved);
  Model after(options(), *saved);
  after.on_end(end("storage", 1, 2, true), 0);
  CHECK(after.pieces() == 2);
  after.on_end(end("storage", 1, 4), 0);
  CHECK(after.station("storage")->pieces.counted == 3);
  CHECK(after.station("storage")->pieces.missed == 1);
  CHECK(after.station("storage")->pieces.faulty == 1);
}

TEST_CASE("an End without SEQ counts when it changes, and not before a piece was finished") {
  Model model(options());
  bus::End plain = end("storage", 0, 0);
  plain.CODE = 0;
  model.on_end(plain, 0);
  CHECK(model.pieces() == 0);
  plain.CODE = 101;
  model.on_end(plain, 0);
  model.on_end(plain, 0);
  plain.CODE = 102;
  model.on_end(plain, 0);
  CHECK(model.pieces() == 2);
}

TEST_CASE("save_version rises with what is saved and with nothing else") {
  Model model = with_all_seen();
  const std::uint64_t before = model.save_version();
  run(model, "storage", 1 * ms);
  model.on_gse(gse("storage", 1, 1), 0);
  CHECK(model.save_version() == before);
  model.on_end(end("storage", 1, 1), 0);
  CHECK(model.save_version() == before + 1);
}

TEST_SUITE_END();

TEST_SUITE_BEGIN("supervisor events");

TEST_CASE("an event is listed once by station, epoch and SEQ [ASE-2]") {
  Model model(options());
  model.on_gse(gse("robot", 1, 1), 0);
  model.on_gse(gse("robot", 1, 1), 0);
  model.on_gse(gse("robot", 2, 1), 0);
  model.on_gse(gse("sealer", 1, 1), 0);
  CHECK(model.events().records().size() == 3);
  CHECK(model.events().missing() == 0);
}

TEST_CASE("a gap in SEQ is noted, and no longer when the event comes late [ASE-2]") {
  EventList list(10);
  CHECK(list.add(gse("robot", 1, 5), 0));  // joined late: what was before is not missing
  CHECK(list.add(gse("robot", 1, 8), 0));
  CHECK(list.records().back().missing_before == 2);
  CHECK(list.missing() == 2);
  CHECK(list.add(gse("robot", 1, 7), 0));
  CHECK(list.missing() == 1);
  CHECK_FALSE(list.add(gse("robot", 1, 7), 0));
  CHECK_FALSE(list.add(gse("robot", 1, 4), 0));
}

TEST_CASE("a known station's new epoch begins at SEQ 1") {
  EventList list(10);
  list.add(gse("robot", 1, 5), 0);
  list.add(gse("robot", 2, 3), 0);
  CHECK(list.records().back().missing_before == 2);
}

TEST_CASE("the list is bounded and its memory of what was seen too") {
  EventList list(100);
  for (std::uint32_t seq = 1; seq <= 20'001; seq += 2) list.add(gse("robot", 1, seq), 0);
  CHECK(list.records().size() == 100);
  CHECK(list.listed() == 10'001);
  CHECK(list.records().back().gse.SEQ == 20'001);
  for (std::uint32_t epoch = 2; epoch < 50; ++epoch) list.add(gse("robot", epoch, 1), 0);
  CHECK_FALSE(list.add(gse("robot", 1, 2), 0));
}

TEST_SUITE_END();

TEST_SUITE_BEGIN("supervisor answers");

bus::MsgRes ask(const std::string& body) {
  Model model = with_all_seen();
  model.on_end(end("storage", 1, 1), 0);
  return answer(model, {"supervisor", body, bus::Order::MSG}, 1 * ms);
}

TEST_CASE("describe tells name, cause and remedy, of ST1203 and of 1203 [REQ-4]") {
  for (const char* code : {"ST1203", "1203"}) {
    const bus::MsgRes reply = ask("describe " + std::string(code) + " from=robot id=17");
    CHECK_FALSE(reply.ERROR);
    CHECK(reply.CODE == 1203);
    CHECK(reply.DEST_STATION == "robot");
    CHECK(reply.BODY.starts_with("id=17 ST1203 "));
    CHECK(reply.BODY.find("Remedy: ") != std::string::npos);
  }
}

TEST_CASE("status tells of one station, or of all in their order [REQ-4]") {
  CHECK(
      ask("status storage").BODY.starts_with("station=storage state=STOPPED intent=run epoch=1 ready=false"));
  CHECK(ask("status storage").BODY.ends_with("pieces=1"));
  const std::string all = ask("status").BODY;
  CHECK(std::ranges::count(all, '\n') == 2);
  CHECK(all.find("station=storage") < all.find("station=sealer"));
}

TEST_CASE(
    "status tells how old the newest Status of a station is, and whether it is in the start order [SYS-7]") {
  Model model(options());
  model.on_status(status("storage", StationState::RUNNING), 0);
  model.on_status(status("painter", StationState::RUNNING), 0);
  const auto said = [&](const std::string& name) {
    return answer(model, {"supervisor", "status " + name, bus::Order::MSG}, 12'500 * ms).BODY;
  };
  CHECK(said("storage").find(" state=away ") != std::string::npos);
  CHECK(said("storage").find(" age=12.5s configured=true ") != std::string::npos);
  CHECK(said("painter").find(" age=12.5s configured=false ") != std::string::npos);
  CHECK(said("sealer") == "station=sealer state=away intent=run configured=true pieces=0");
}

TEST_CASE("pieces and help are answered") {
  CHECK(ask("pieces").BODY.starts_with("pieces=1 counted_at=storage\nstation=storage counted=1 missed=0"));
  CHECK(ask("help id=3").BODY.starts_with("id=3 describe CODE"));
}

TEST_CASE("what is unknown is refused with a reason [REQ-5]") {
  CHECK(ask("dance").STATUS == 1307);
  CHECK(ask("").STATUS == 1307);
  CHECK(ask("status painter").STATUS == 1310);
  CHECK(ask("describe ST4").ERROR);
  CHECK(ask("describe banana").STATUS == 1308);
  CHECK(ask("describe").STATUS == 1308);
  Model model(options());
  CHECK(answer(model, {"supervisor", "status", bus::Order::START}, 0).STATUS == 1301);
}

TEST_SUITE_END();

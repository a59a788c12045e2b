#include "supervisor/model.hpp"

#include <algorithm>
#include <utility>

#include "dds_bridge/body.hpp"
#include "dds_bridge/text.hpp"

namespace stationd::supervisor {
namespace {

using bus::code_text;
using bus::count_text;
using bus::printable;
using bus::short_duration;
using bus::state_text;

constexpr std::size_t kMaxStations = 1000;  // names come over the network
constexpr std::size_t kMaxNotes = 1000;
constexpr std::size_t kMaxBodyBytes = 1 << 20;  // the bus has judged it

std::uint32_t number_of(StationState state) { return static_cast<std::uint32_t>(state); }
std::uint32_t number_of(StopCause cause) { return static_cast<std::uint32_t>(cause); }

bool is_stopped(const bus::Status& status, StopCause cause) {
  return status.STATE == number_of(StationState::STOPPED) && status.STOP_CAUSE == number_of(cause);
}

}  // namespace

Model::Model(ModelOptions options, const SavedState& saved)
    : options_(std::move(options)), events_(options_.events_kept) {
  if (options_.count_at.empty() && !options_.stations.empty()) options_.count_at = options_.stations.front();
  for (const std::string& name : options_.stations) {
    StationRecord& station = stations_.emplace_back();
    station.name = name;
    station.configured = true;
  }
  for (const auto& [name, remembered] : saved) {
    StationRecord* station = find_or_add(name);
    if (station == nullptr) break;
    station->intent = remembered.intent;
    station->pieces = remembered.pieces;
  }
}

StationRecord* Model::find(std::string_view name) noexcept {
  const auto it = std::ranges::find(stations_, name, &StationRecord::name);
  return it == stations_.end() ? nullptr : &*it;
}

const StationRecord* Model::station(std::string_view name) const noexcept {
  const auto it = std::ranges::find(stations_, name, &StationRecord::name);
  return it == stations_.end() ? nullptr : &*it;
}

StationRecord* Model::find_or_add(const std::string& name) {
  if (StationRecord* known = find(name)) return known;
  if (name.empty() || stations_.size() >= kMaxStations) return nullptr;
  StationRecord& station = stations_.emplace_back();
  station.name = name;
  return &station;
}

void Model::note(std::string text) {
  if (notes_.size() < kMaxNotes) notes_.push_back(std::move(text));
}

std::vector<std::string> Model::take_notes() { return std::exchange(notes_, {}); }

void Model::set_role(Role role) {
  if (role == role_) return;
  role_ = role;
  note(role == Role::commanding ? "this supervisor commands the cell" : "this supervisor only observes");
}

void Model::set_intent(StationRecord& station, Intent intent, std::string_view why) {
  if (station.intent == intent) return;
  station.intent = intent;
  ++save_version_;
  if (!station.configured) return;
  const std::string_view consequence = intent == Intent::run ? "is kept running" : "is not started by itself";
  note(station.name + " " + std::string(consequence) + ": " + std::string(why));
}

bool Model::away(const StationRecord& station, std::int64_t now_ns) const noexcept {
  return !station.status || now_ns - station.seen_ns > options_.stale_after_ns;
}

std::uint64_t Model::pieces() const noexcept {
  const StationRecord* last = station(options_.count_at);
  return last == nullptr ? 0 : last->pieces.finished();
}

SavedState Model::saved() const {
  SavedState state;
  for (const StationRecord& station : stations_) state[station.name] = {station.intent, station.pieces};
  return state;
}

// -- What comes in ----------------------------------------------------------------------------------------

void Model::on_status(const bus::Status& status, std::int64_t now_ns) {
  StationRecord* station = find_or_add(status.STATION);
  if (station == nullptr) return;
  const std::optional<bus::Status> before = std::exchange(station->status, status);
  station->seen_ns = now_ns;
  const bool new_epoch = before && before->EPOCH != status.EPOCH;
  if (new_epoch) {
    ++station->restarts;
    station->start_sent_ns.reset();
  }
  follow_intent(*station, before && !new_epoch ? &*before : nullptr, status, now_ns);
  if (is_stopped(status, StopCause::never_started) && station->pieces.epochs.empty()) {
    station->pieces.begin(status.EPOCH);
    ++save_version_;
  }
  note_changes(*station, before ? &*before : nullptr, status);
}

/// `before`: the same epoch's former Status. A Stop or a fault is taken from its edge, so that an operator's
/// Start, seen while Status still says STOPPED, is not undone by the next repetition.
void Model::follow_intent(StationRecord& station, const bus::Status* before, const bus::Status& status,
                          std::int64_t now_ns) {
  const auto edge = [&](auto holds) { return holds(status) && (before == nullptr || !holds(*before)); };
  const bool may_start_late =
      station.start_crossed && now_ns - station.stop_seen_ns <= 2 * options_.start_repeat_ns;
  if (status.STATE != number_of(StationState::RUNNING) && !may_start_late) station.stop_awaited = false;
  if (status.STATE == number_of(StationState::RUNNING)) {
    station.has_run = true;
    if (!station.stop_awaited) set_intent(station, Intent::run, "it was started");
  }
  if (edge([](const bus::Status& s) { return is_stopped(s, StopCause::ordered); }))
    set_intent(station, Intent::stopped, "an operator stopped it");
  const bool after_fault = edge([](const bus::Status& s) { return is_stopped(s, StopCause::after_fault); });
  if ((after_fault || status.STATE == number_of(StationState::FAULT)) && station.intent == Intent::run)
    set_intent(station, Intent::faulted, "it faulted; an operator starts it");
}

void Model::note_changes(const StationRecord& station, const bus::Status* before, const bus::Status& status) {
  const std::string name = printable(station.name);
  if (before == nullptr) {
    note(name + " seen on " + printable(status.CONTROLLER) + ": " + state_text(status.STATE));
  } else if (before->EPOCH != status.EPOCH) {
    note(name + " restarted (epoch " + std::to_string(status.EPOCH) + "): " + state_text(status.STATE));
  } else if (before->STATE != status.STATE) {
    note(name + " " + state_text(status.STATE));
  }
  const bool same = before != nullptr && before->FAULT == status.FAULT;
  if (status.FAULT != 0 && !same) note(name + " fault " + code_text(status.FAULT));
}

void Model::on_set(const bus::Set& set, std::int64_t) {
  if (StationRecord* station = find_or_add(set.STATION)) station->announced = set;
}

void Model::on_end(const bus::End& end, std::int64_t) {
  StationRecord* station = find_or_add(end.STATION);
  if (station == nullptr) return;
  station->finished = end;
  const std::uint64_t missed = station->pieces.missed;
  if (!station->pieces.add(end)) return;
  ++save_version_;
  const std::string name = printable(station->name);
  if (station->pieces.missed != missed)
    note(name + ": " + count_text(station->pieces.missed - missed, "piece") +
         " finished unseen before this one");
  note(name + " finished piece " + std::to_string(station->pieces.finished()) + ", code " +
       std::to_string(end.CODE) + (end.ERROR ? ", with error " + code_text(end.STATUS) : ""));
}

void Model::on_gse(const bus::Gse& gse, std::int64_t now_ns) {
  if (!events_.add(gse, now_ns)) return;
  const EventRecord& record = events_.records().back();
  if (record.missing_before != 0)
    note(printable(gse.STATION) + ": " + count_text(record.missing_before, "event") + " lost");
  note("event " + event_text(record));
}

void Model::on_start(const bus::MsgReq& order, std::uint64_t receipt_number) {
  StationRecord* station = find(order.DEST_STATION);
  if (station == nullptr || receipt_number < station->stop_number) return;
  if (bus::parse_body(order.BODY, kMaxBodyBytes).from == options_.name) return;
  station->stop_awaited = false;
  station->start_crossed = false;
  if (!station->in_state(StationState::FAULT)) set_intent(*station, Intent::run, "an operator ordered Start");
}

void Model::on_stop(const bus::MsgReq& order, std::uint64_t receipt_number, std::int64_t now_ns) {
  StationRecord* station = find(order.DEST_STATION);
  if (station == nullptr) return;
  const bus::Body body = bus::parse_body(order.BODY, kMaxBodyBytes);
  if (body.from == options_.name) return;
  station->stop_number = receipt_number;
  station->start_crossed =
      station->start_sent_ns && now_ns - *station->start_sent_ns <= 2 * options_.start_repeat_ns;
  station->stop_awaited = station->start_crossed || station->in_state(StationState::RUNNING);
  station->stop_seen_ns = now_ns;
  const auto mode = std::ranges::find(body.pairs, "mode", &std::pair<std::string, std::string>::first);
  station->stop_mode = mode == body.pairs.end() ? "" : "mode=" + mode->second;
  set_intent(*station, Intent::stopped, "an operator ordered Stop");
}

void Model::on_liveliness(std::string_view topic, int alive) {
  if (topic != "Status") return;
  if (alive < writers_alive_)
    note("a controller has left the bus; " + std::to_string(alive) + (alive == 1 ? " is" : " are") +
         " there");
  writers_alive_ = alive;
}

// -- What is ordered --------------------------------------------------------------------------------------

std::vector<Action> Model::tick(std::int64_t now_ns) {
  note_away(now_ns);
  std::vector<Action> actions;
  if (role_ != Role::commanding) return actions;
  for (std::size_t i = 0; i < options_.stations.size(); ++i) {
    StationRecord& station = stations_[i];
    if (wants_start(i, now_ns)) {
      if (!station.start_sent_ns) note(station.name + ": Start sent");
      station.start_sent_ns = now_ns;
      ++station.starts_sent;
      actions.push_back({Action::Kind::start, station.name, {}});
    } else if (wants_stop_again(station, now_ns)) {
      note(station.name + ": an operator's Stop crossed our Start and is repeated");
      station.stop_seen_ns = now_ns;
      actions.push_back({Action::Kind::repeat_stop, station.name, station.stop_mode});
    }
  }
  return actions;
}

void Model::note_away(std::int64_t now_ns) {
  noted_away_.resize(stations_.size(), false);
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    const bool now_away = stations_[i].status && away(stations_[i], now_ns);
    if (now_away == noted_away_[i]) continue;
    noted_away_[i] = now_away;
    const std::string name = printable(stations_[i].name);
    note(now_away ? name + " is away: no Status for " + short_duration(options_.stale_after_ns)
                  : name + " is back");
  }
}

/// The cell comes up in order: a station waits until the one before it runs. One that has run before and came
/// back waits only for a predecessor that is being started as well, not for one that an operator or a fault
/// holds.
bool Model::waits_for_its_turn(std::size_t index, std::int64_t now_ns) const noexcept {
  if (index == 0) return false;
  const StationRecord& before = stations_[index - 1];
  if (before.in_state(StationState::RUNNING) && !away(before, now_ns)) return false;
  return !stations_[index].has_run || before.intent == Intent::run;
}

bool Model::wants_start(std::size_t index, std::int64_t now_ns) const noexcept {
  const StationRecord& station = stations_[index];
  if (station.intent != Intent::run || away(station, now_ns)) return false;
  if (!is_stopped(*station.status, StopCause::never_started)) return false;
  if (station.start_sent_ns && now_ns - *station.start_sent_ns < options_.start_repeat_ns) return false;
  return !waits_for_its_turn(index, now_ns);
}

bool Model::wants_stop_again(const StationRecord& station, std::int64_t now_ns) const noexcept {
  return station.stop_awaited && station.start_crossed && station.in_state(StationState::RUNNING) &&
         !away(station, now_ns) && now_ns - station.stop_seen_ns >= options_.start_repeat_ns;
}

}  // namespace stationd::supervisor

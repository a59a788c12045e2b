#include "programs/cell_station.hpp"

#include <algorithm>
#include <string>

#include "scan/codes.hpp"

namespace stationd::programs {
namespace {

constexpr Time kStepTimeout{10'000'000'000};
constexpr Time kArrivalTimeout{30'000'000'000};
constexpr Time kBlockedAfter{60'000'000'000};
constexpr Time kTimeMin{100'000'000};
constexpr Time kTimeMax{3'600'000'000'000};
constexpr std::int64_t kConflict_ns = 100'000'000;

}  // namespace

PieceInputs::PieceInputs(Program& owner, const std::string& prefix, const std::string& topic)
    : code(owner, prefix + ".CODE", "code of the piece in the upstream station's " + topic),
      error(owner, prefix + ".ERROR", "the upstream station could not finish it"),
      status(owner, prefix + ".STATUS", "why not"),
      epoch(owner, prefix + ".EPOCH", "epoch of the piece's number"),
      seq(owner, prefix + ".SEQ", "number of the piece") {}

std::vector<PvMember> PieceInputs::members() const {
  return {{"CODE", &code}, {"ERROR", &error}, {"STATUS", &status}, {"EPOCH", &epoch}, {"SEQ", &seq}};
}

PieceOutputs::PieceOutputs(Program& owner, const std::string& topic)
    : code(owner, topic + ".CODE", "code of the piece"),
      error(owner, topic + ".ERROR", "something is wrong with it"),
      status(owner, topic + ".STATUS", "what is wrong; 0: nothing"),
      epoch(owner, topic + ".EPOCH", "epoch in which the piece was numbered"),
      seq(owner, topic + ".SEQ", "number of the piece within the epoch") {}

std::vector<PvMember> PieceOutputs::members() const {
  return {{"CODE", &code}, {"ERROR", &error}, {"STATUS", &status}, {"EPOCH", &epoch}, {"SEQ", &seq}};
}

CellStation::Press::Press(Program& owner)
    : is_up(owner, "press_is_up", "end switch"), is_down(owner, "press_is_down", "end switch"),
      lid_seated(owner, "lid_seated", "the press has held the lid down for as long as the type needs"),
      down(owner, "press_down", "press goes down; de-energised: up") {}

CellStation::Upstream::Upstream(Program& owner)
    : ready(owner, "ready", "Set"), begin(owner, "begin", "End"),
      state(owner, "previous.STATE", "state of the upstream station") {}

CellStation::Downstream::Downstream(Program& owner)
    : state(owner, "next.STATE", "state of the downstream station"),
      ready(owner, "next.READY", "the downstream station is willing to take a pallet") {}

CellStation::QueueTags::QueueTags(Program& owner, int place)
    : epoch(owner, "queue." + std::to_string(place) + ".epoch", "announcement"),
      seq(owner, "queue." + std::to_string(place) + ".seq", "announcement"),
      code(owner, "queue." + std::to_string(place) + ".code", "announcement"),
      ended(owner, "queue." + std::to_string(place) + ".ended", "the upstream station has finished it") {}

CellStation::CellStation(const ProgramOptions& options, const Traits& traits)
    : pallet_at_entry(*this, "pallet_at_entry", "a pallet stands against the entry stopper"),
      pallet_in_transfer(*this, "pallet_in_transfer", "a pallet is in the transfer zone"),
      pallet_in_position(*this, "pallet_in_position", "a pallet stands in the work position"),
      next_entry_clear(*this, "next_entry_clear", "the next station's entry zone is clear"),
      entry_stopper_is_open(*this, "entry_stopper_is_open", "end switch"),
      entry_stopper_is_closed(*this, "entry_stopper_is_closed", "end switch"),
      stopper_is_open(*this, "stopper_is_open", "end switch"),
      stopper_is_closed(*this, "stopper_is_closed", "end switch"),
      clamp_is_closed(*this, "clamp_is_closed", "end switch"),
      clamp_is_open(*this, "clamp_is_open", "end switch"), arm_is_up(*this, "arm_is_up", "end switch"),
      arm_is_down(*this, "arm_is_down", "end switch"),
      gripper_is_open(*this, "gripper_is_open", "end switch"),
      gripper_is_closed(*this, "gripper_is_closed", "end switch"),
      part_in_gripper(*this, "part_in_gripper", "the gripper holds a part"),
      code_valid(*this, "code_valid", "the code reader has read the pallet in position"),
      pallet_code(*this, "pallet_code", "code of the pallet in position; 0 while none is read"),
      arm_position(*this, "arm_position", "0 between positions, else the position reached"),
      conveyor(*this, "conveyor", "belt runs"),
      entry_stopper_open(*this, "entry_stopper_open", "de-energised: closed"),
      stopper_open(*this, "stopper_open", "de-energised: closed"),
      clamp_close(*this, "clamp_close", "de-energised: open"),
      read_code(*this, "read_code", "code reader on"),
      arm_enable(*this, "arm_enable", "arm goes to arm_target; de-energised: stands"),
      arm_down(*this, "arm_down", "de-energised: arm goes up"),
      gripper_close(*this, "gripper_close", "held outside RUNNING: the gripper may hold a part", true),
      arm_target(*this, "arm_target", "position to go to"),
      piece_stored(*this, "piece.stored", "the piece in work was put on its shelf"),
      piece_status(*this, "piece.status", "what is wrong with the piece in work; 0: nothing"),
      types_(options.recipes, traits.kinds, traits.press),
      carries_pieces_(std::ranges::find(traits.kinds, Kind::piece) != traits.kinds.end()),
      step_timeout_(*this, "step_timeout", "longest time that a step may take", kStepTimeout, kTimeMin,
                    kTimeMax),
      arrival_timeout_(*this, "arrival_timeout", "longest way of a pallet from the upstream station's End",
                       kArrivalTimeout, kTimeMin, kTimeMax),
      blocked_after_(*this, "blocked_after", "waiting for a neighbour becomes a warning after this",
                     kBlockedAfter, kTimeMin, kTimeMax),
      piece_code_(*this, "piece.code", "code of the piece in work; 0: none"),
      piece_epoch_(*this, "piece.epoch", "its number's epoch"), piece_seq_(*this, "piece.seq", "its number"),
      piece_from_epoch_(*this, "piece.from_epoch", "the upstream station's epoch for it"),
      piece_from_seq_(*this, "piece.from_seq", "the upstream station's number for it"),
      piece_begun_(*this, "piece.begun", "the upstream station's End came"),
      piece_ended_(*this, "piece.ended", "all is done here"),
      piece_placing_(*this, "piece.placing", "bit per kind of part: putting it down was begun"),
      number_epoch_(*this, "number.epoch", "epoch of the last number given"),
      number_seq_(*this, "number.seq", "last number given"),
      grip_kind_(*this, "grip.kind", "what the gripper holds: 1 base, 2 bearing, 3 shaft, 4 lid, 5 piece"),
      grip_variant_(*this, "grip.variant", "its variant, or the shelf"), queue_tags_{QueueTags(*this, 1),
                                                                                     QueueTags(*this, 2),
                                                                                     QueueTags(*this, 3)},
      queue_size_(*this, "queue.size", "announcements that wait"),
      queue_last_epoch_(*this, "queue.last_epoch", "of the newest Set acted on"),
      queue_last_seq_(*this, "queue.last_seq", "of the newest Set acted on"),
      queue_last_code_(*this, "queue.last_code", "of the newest Set acted on"), set_(*this, "Set"),
      end_(*this, "End"), track_step_tag_(*this, "track_step", "step of the track"),
      arm_step_tag_(*this, "arm_step", "step of the arm") {
  needs({&pallet_at_entry, &pallet_in_transfer, &pallet_in_position, &next_entry_clear,
         &entry_stopper_is_open, &entry_stopper_is_closed, &stopper_is_open, &stopper_is_closed,
         &clamp_is_closed, &clamp_is_open, &arm_is_up, &arm_is_down, &gripper_is_open, &gripper_is_closed,
         &part_in_gripper, &code_valid, &pallet_code, &arm_position});
  pairs_ = {{&entry_stopper_is_open, &entry_stopper_is_closed},
            {&stopper_is_open, &stopper_is_closed},
            {&clamp_is_closed, &clamp_is_open},
            {&arm_is_up, &arm_is_down},
            {&gripper_is_open, &gripper_is_closed}};
  if (traits.press) {
    press_.emplace(*this);
    needs({&press_->is_up, &press_->is_down, &press_->lid_seated});
    pairs_.push_back({&press_->is_up, &press_->is_down});
  }
  publish("Set", set_.members());
  publish("End", end_.members());
  if (!options.upstream.empty()) {
    upstream_.emplace(*this);
    subscribe("Set", options.upstream, upstream_->ready.members());
    subscribe("End", options.upstream, upstream_->begin.members());
    subscribe("Status", options.upstream, {{"STATE", &upstream_->state}});
  }
  if (!options.downstream.empty()) {
    downstream_.emplace(*this);
    subscribe("Status", options.downstream, {{"STATE", &downstream_->state}, {"READY", &downstream_->ready}});
  }
}

void CellStation::set_placing(Kind kind, bool on) noexcept {
  const std::uint32_t bit = 1U << static_cast<unsigned>(kind);
  piece_placing_ = on ? piece_placing_ | bit : piece_placing_ & ~bit;
}

void CellStation::fail(Cycle& cycle, std::uint32_t code, std::int64_t detail) noexcept {
  if (failed_) return;
  failed_ = true;
  asked_ = code;
  asked_code_ = pallet_code;
  cycle.fault(code, detail);
}

void CellStation::execute(Cycle& cycle) noexcept {
  failed_ = false;
  load(cycle);
  if (cycle.started()) begin(cycle);
  hear(cycle);
  if (gap_heard_) {
    gap_heard_ = false;
    fail(cycle, code::announcement_gap);
  }
  if (inputs_usable(cycle) && switches_agree(cycle)) {
    if (!derived_) derive_all(cycle);
    run_track(cycle);
    run_arm(cycle);
    drive();
  }
  report(cycle);
}

void CellStation::idle(Cycle& cycle) noexcept {
  load(cycle);
  hear(cycle);
  paused_ = true;
}

/// First scan after Start. Until the inputs are known the gripper is kept closed if it may hold something.
void CellStation::begin(Cycle& cycle) noexcept {
  derived_ = false;
  paused_ = true;
  conflict_ = false;
  answered_ = asked_;
  answered_code_ = asked_code_;
  asked_ = 0;
  started_ns_ = cycle.now_ns();
  step_ = Step::settle;
  if (grip_kind_ != 0) gripper_close = true;
}

/// BAD is a fault, but for the first moments after Start; STALE holds everything where it is.
bool CellStation::inputs_usable(Cycle& cycle) noexcept {
  Quality worst = Quality::FORCED;
  for (const Handle* input : field_) worst = std::min(worst, input->quality());
  if (worst >= Quality::GOOD) {
    if (!paused_) clock_ns_ += cycle.now_ns() - last_ns_;
    last_ns_ = cycle.now_ns();
    paused_ = false;
    return !failed_;
  }
  paused_ = true;
  arm_.look_away();
  const bool coming = !derived_ && cycle.now_ns() - started_ns_ <= step_timeout_.get().ns;
  if (!coming && worst == Quality::BAD) fail(cycle, code::inputs_lost);
  return false;
}

/// A pair of end switches that are both on for longer than a glitch: one is stuck.
bool CellStation::switches_agree(Cycle& cycle) noexcept {
  std::int64_t number = 0, found = 0;
  for (const Pair& pair : pairs_) {
    ++number;
    if (pair.one->get() && pair.other->get()) found = number;
  }
  if (found == 0) {
    conflict_ = false;
    return true;
  }
  if (!conflict_) conflict_ns_ = clock_ns_;
  conflict_ = true;
  if (clock_ns_ - conflict_ns_ > kConflict_ns) fail(cycle, code::end_switches_conflict, found);
  return !failed_;
}

/// The step follows from the sensors; the record says only what they cannot show.
void CellStation::derive_all(Cycle& cycle) noexcept {
  derived_ = true;
  const ArmInputs in = arm_inputs();
  if (!in.part) grip_kind_ = 0;
  Errand held;
  held.kind = static_cast<Kind>(grip_kind_.get());
  held.variant = grip_variant_;
  const auto feeder = static_cast<std::uint16_t>(kArmFirstFeeder + held.variant - 1);
  held.to = held.kind == Kind::piece ? feeder : kArmOverPallet;
  held.from = kArmOverPallet;
  arm_.restart(in, held, clock_ns_);
  recorded_for_ = Record::none;
  derive(piece_type());
  resolve_lost_pallets(cycle);
  record_ticket_ = cycle.save_retained();
  go(Step::settle);
}

ArmInputs CellStation::arm_inputs() const noexcept {
  return {arm_is_up, arm_is_down, gripper_is_open, gripper_is_closed, part_in_gripper, arm_position};
}

/// For the piece in work what it lacks; between pieces the first part of the one announced, fetched ahead.
Errand CellStation::errand_now(const Cycle& cycle) const noexcept {
  if (step_ == Step::settle || step_ == Step::press || step_ == Step::press_up) return {};
  if (piece_code_ != 0 && !piece_ended_) {
    const PieceType* type = piece_type();
    return type != nullptr ? wanted(*type, step_ == Step::work) : Errand{};
  }
  if (cycle.finishing() || queue_.front() == nullptr) return {};
  const PieceType* type = types_.find(queue_.front()->code);
  return type != nullptr ? wanted(*type, false) : Errand{};
}

ArmPermits CellStation::arm_permits(const Cycle& cycle) noexcept {
  ArmPermits may;
  may.errand = errand_now(cycle);
  may.needed = step_ == Step::work && !may.errand.none();
  may.lower = step_ != Step::settle && step_ != Step::release && step_ != Step::close_stopper;
  const Errand& errand = arm_.errand();
  may.pick = !errand.none() && source_ready(errand);
  may.place = may.needed && errand.kind == may.errand.kind && errand.variant == may.errand.variant;
  may.lower_place = step_ == Step::work && target_free(errand) && clamp_is_closed && !clamp_is_open;
  may.wait_place = target_full(errand);
  may.placed = placed(errand);
  may.recorded = recorded_for_ != Record::none && recorded_for_ == arm_.asks() && cycle.saved(arm_ticket_);
  return may;
}

/// The arm stands still until it is on disk what was derived: moving it can change what the sensors show.
void CellStation::run_arm(Cycle& cycle) noexcept {
  if (failed_ || (step_ == Step::settle && !cycle.saved(record_ticket_))) return;
  const ArmPermits may = arm_permits(cycle);
  const std::uint32_t wrong = arm_.run(arm_inputs(), may, clock_ns_, step_timeout_.get().ns);
  const Errand& errand = arm_.errand();
  const std::int64_t detail = static_cast<std::int64_t>(errand.kind) * 10 + errand.variant;
  if (wrong != 0) return fail(cycle, wrong, detail);
  const bool waits = arm_.step() == ArmStep::wait_source && !source_ready(errand);
  const bool full = arm_.step() == ArmStep::wait_target && target_full(errand);
  cycle.warn(source_warning(), waits || full, detail);
  record_for_arm(cycle);
}

void CellStation::record_for_arm(Cycle& cycle) noexcept {
  const Record asks = arm_.asks();
  if (asks == recorded_for_) return;
  recorded_for_ = asks;
  const Errand& errand = arm_.errand();
  switch (asks) {
    case Record::none: return;
    case Record::pick:
      grip_kind_ = static_cast<std::uint8_t>(errand.kind);
      grip_variant_ = errand.variant;
      break;
    case Record::place: set_placing(errand.kind, true); break;
    case Record::placed: piece_stored = true; break;
  }
  arm_ticket_ = cycle.save_retained();
}

/// Outputs follow from the step. The belt stands while a second pallet could slip past the entry stopper.
void CellStation::drive() noexcept {
  conveyor = step_ != Step::settle && (step_ == Step::admit || entry_stopper_is_closed);
  entry_stopper_open = step_ == Step::admit;
  stopper_open = step_ == Step::release;
  clamp_close = step_ >= Step::clamp && step_ <= Step::record_end;
  read_code = step_ == Step::read || step_ == Step::identify;
  if (press_) press_->down = step_ == Step::press;
  const ArmOutputs& arm = arm_.outputs();
  arm_enable = arm.enable;
  arm_down = arm.down;
  gripper_close = arm.close;
  arm_target = arm.target;
}

void CellStation::report(Cycle& cycle) noexcept {
  const bool arm_works = step_ == Step::work && arm_.step() != ArmStep::idle;
  track_step_tag_ = static_cast<std::uint32_t>(step_);
  arm_step_tag_ = static_cast<std::uint32_t>(arm_.step());
  const bool heard = !upstream_ || (upstream_->ready.good() && cycle.saved(queue_ticket_));
  const bool ready =
      !failed_ && !paused_ && heard && step_ != Step::settle && !pallet_at_entry && !cycle.finishing();
  cycle.report(arm_works ? arm_step_tag_ : track_step_tag_, piece_code_, ready);
}

/// What an operator has to take away first; everything else is found out by starting again.
std::uint32_t CellStation::reset_obstacle(const Cycle& cycle) noexcept {
  static_cast<void>(cycle);
  if (asked_ == code::inputs_lost)
    for (const Handle* input : field_)
      if (!input->good()) return code::inputs_lost;
  const bool in_the_way = asked_ == code::gripper_unknown_part || asked_ == code::gripper_wrong_part;
  if (in_the_way && part_in_gripper) return asked_;
  if (asked_ == code::transfer_occupied && pallet_in_transfer) return asked_;
  return 0;
}

std::string_view CellStation::step_name(std::uint32_t step) const noexcept {
  const bool unused = step == static_cast<std::uint32_t>(ArmStep::record_placed) && !carries_pieces_;
  if (step >= kArmStepFirst) return unused ? std::string_view{} : arm_step_name(step);
  switch (static_cast<Step>(step)) {
    case Step::settle: return "settle";
    case Step::wait_pallet: return "wait for a pallet";
    case Step::admit: return "admit the pallet";
    case Step::carry_in: return "carry it into position";
    case Step::clamp: return "clamp";
    case Step::read: return "read the code";
    case Step::identify: return "identify the piece";
    case Step::wait_begin: return upstream_ ? "wait for the upstream station's End" : "";
    case Step::work: return "work";
    case Step::press: return press_ ? "press" : "";
    case Step::press_up: return press_ ? "press up" : "";
    case Step::record_end: return "record the end";
    case Step::unclamp: return "unclamp";
    case Step::wait_next: return "wait for the next station";
    case Step::release: return "release the pallet";
    case Step::close_stopper: return "close the stopper";
  }
  return {};
}

}  // namespace stationd::programs

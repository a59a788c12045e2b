// The track's steps: a pallet from the entry through the work position to the next station. Scan thread.
#include "programs/cell_station.hpp"
#include "scan/codes.hpp"
#include "scan/messages.hpp"

namespace stationd::programs {

void CellStation::go(Step step) noexcept {
  step_ = step;
  entered_ns_ = clock_ns_;
  arrival_ns_ = clock_ns_;
  pressed_ns_ = -1;
  waits_at_entry_ns_ = clock_ns_;
}

bool CellStation::late(std::int64_t more_ns) const noexcept {
  return clock_ns_ - entered_ns_ > step_timeout_.get().ns + more_ns;
}

void CellStation::run_track(Cycle& cycle) noexcept {
  if (failed_) return;
  const bool holds_pallet = step_ >= Step::clamp && step_ <= Step::wait_next;
  if (holds_pallet && !pallet_in_position) return fail(cycle, code::pallet_removed);
  const bool judged = step_ >= Step::work && step_ <= Step::wait_next;
  if (judged) {
    if (const std::uint32_t wrong = contradiction(0); wrong != 0) return fail(cycle, wrong);
  }
  switch (step_) {
    case Step::settle: return run_settle(cycle);
    case Step::wait_pallet: return run_wait_pallet(cycle);
    case Step::admit:
    case Step::carry_in: return run_arrival(cycle);
    case Step::clamp:
    case Step::read: return run_clamp_and_read(cycle);
    case Step::identify: return run_identify(cycle);
    case Step::wait_begin: return run_wait_begin(cycle);
    case Step::work: return run_work(cycle);
    case Step::press:
    case Step::press_up: return run_press(cycle);
    case Step::record_end:
    case Step::unclamp: return run_end(cycle);
    case Step::wait_next: return run_wait_next(cycle);
    case Step::release:
    case Step::close_stopper: return run_release(cycle);
  }
}

void CellStation::run_settle(Cycle& cycle) noexcept {
  const bool saved = cycle.saved(record_ticket_);
  const bool press_up = !press_ || (press_->is_up && !press_->is_down);
  if (saved && entry_stopper_is_closed && stopper_is_closed && press_up && arm_.clear()) {
    publish_piece();
    go(pallet_in_position ? Step::clamp : pallet_in_transfer ? Step::carry_in : Step::wait_pallet);
  } else if (late()) {
    // The arm has time-outs of its own.
    fail(cycle, !saved                     ? code::record_not_saved
                : !entry_stopper_is_closed ? code::entry_stopper_jammed
                : !stopper_is_closed       ? code::stopper_jammed
                : !press_up                ? code::press_jammed
                                           : code::step_timeout);
  }
}

void CellStation::run_wait_pallet(Cycle& cycle) noexcept {
  const bool comes = pallet_in_position || pallet_in_transfer || pallet_at_entry;
  cycle.warn(code::no_pallet, !comes && clock_ns_ - entered_ns_ > blocked_after_.get().ns);
  if (pallet_in_position) return go(Step::clamp);
  if (pallet_in_transfer) return go(Step::carry_in);
  if (cycle.finishing()) {
    if (arm_.resting()) cycle.finished();
    return;
  }
  if (!pallet_at_entry) {
    waits_at_entry_ns_ = clock_ns_;
    return watch_arrival(cycle);
  }
  if (clamp_is_open && !clamp_is_closed && stopper_is_closed) return go(Step::admit);
  if (clock_ns_ - waits_at_entry_ns_ > step_timeout_.get().ns)
    fail(cycle, stopper_is_closed ? code::clamp_jammed : code::stopper_jammed);
}

/// A pallet that the upstream station has let go must come, while that station runs and this one takes it.
void CellStation::watch_arrival(Cycle& cycle) noexcept {
  const bool due = upstream_ && upstream_->state.good() &&
                   upstream_->state == static_cast<std::uint32_t>(StationState::RUNNING) &&
                   upstream_->begin.good() && queue_.ended_count() > visible();
  if (!due) arrival_ns_ = clock_ns_;
  if (clock_ns_ - arrival_ns_ <= arrival_timeout_.get().ns) return;
  if (answered_ != code::pallet_missing) return fail(cycle, code::pallet_missing, queue_.front()->seq);
  answered_ = 0;
  cycle.note(code::announcement_dropped, queue_.front()->seq);
  queue_.pop_front();
  store_queue(cycle);
  arrival_ns_ = clock_ns_;
}

void CellStation::run_arrival(Cycle& cycle) noexcept {
  if (step_ == Step::admit) {
    if (pallet_in_transfer || pallet_in_position) return go(Step::carry_in);
    if (!late()) return;
    return fail(cycle, !entry_stopper_is_open ? code::entry_stopper_jammed
                       : pallet_at_entry      ? code::pallet_stuck_at_entry
                                              : code::pallet_vanished);
  }
  if (pallet_in_position && entry_stopper_is_closed && !entry_stopper_is_open) return go(Step::clamp);
  if (!late()) return;
  fail(cycle, !entry_stopper_is_closed || entry_stopper_is_open ? code::entry_stopper_jammed
              : pallet_in_transfer                              ? code::pallet_stuck_in_transfer
                                                                : code::pallet_vanished);
}

void CellStation::run_clamp_and_read(Cycle& cycle) noexcept {
  if (step_ == Step::clamp) {
    if (clamp_is_closed && !clamp_is_open) return go(Step::read);
    if (late()) fail(cycle, code::clamp_jammed);
    return;
  }
  if (code_valid && pallet_code != 0) {
    record_ticket_ = 0;
    go(Step::identify);
    return identify(cycle);
  }
  if (late()) fail(cycle, code::code_unreadable);
}

void CellStation::run_identify(Cycle& cycle) noexcept {
  if (!cycle.saved(record_ticket_)) {
    if (late()) fail(cycle, code::record_not_saved);
    return;
  }
  publish_piece();
  if (piece_ended_) return go(Step::unclamp);
  if (const std::uint32_t wrong = contradiction(answered_); wrong != 0) return fail(cycle, wrong);
  go(upstream_ && !piece_begun_ ? Step::wait_begin : Step::work);
}

/// The upstream station is at a later piece, so it has let this one go.
bool CellStation::names_later(const PieceInputs& other) const noexcept {
  if (!other.good() || other.code == 0) return false;
  return other.epoch > piece_from_epoch_ || (other.epoch == piece_from_epoch_ && other.seq > piece_from_seq_);
}

void CellStation::run_wait_begin(Cycle& cycle) noexcept {
  const PieceInputs& begin = upstream_->begin;
  const bool named = begin.good() && begin.epoch == piece_from_epoch_ && begin.seq == piece_from_seq_ &&
                     begin.code == piece_code_;
  const bool later = names_later(begin) || names_later(upstream_->ready);
  const bool answered = answered_ == code::begin_missing || answered_ == code::begin_error;
  if (named && begin.error && !answered) return fail(cycle, code::begin_error, begin.status);
  if (named || later || answered) {
    piece_begun_ = true;
    return go(Step::work);
  }
  if (late()) fail(cycle, code::begin_missing, piece_from_seq_);
}

/// The arm works through what wanted() names; its steps have the time-outs.
void CellStation::run_work(Cycle& cycle) noexcept {
  const PieceType* type = piece_type();
  if (type == nullptr) return fail(cycle, code::code_unknown, piece_code_);
  if (!wanted(*type, true).none()) return;
  if (arm_.step() == ArmStep::hold && carries(Kind::piece)) return fail(cycle, code::gripper_unknown_part);
  if (!arm_.resting() || arm_position != kArmHome || !arm_is_up) return;
  go(press_ ? Step::press : Step::record_end);
  if (press_) return;
  piece_ended_ = true;
  record_ticket_ = cycle.save_retained();
}

void CellStation::run_press(Cycle& cycle) noexcept {
  const PieceType* type = piece_type();
  const std::int64_t press_ns = type != nullptr ? type->press_ns : 0;
  if (step_ == Step::press) {
    const bool is_down = press_->is_down && !press_->is_up;
    if (!is_down)
      pressed_ns_ = -1;
    else if (pressed_ns_ < 0)
      pressed_ns_ = clock_ns_;
    const bool pressed = is_down && clock_ns_ - pressed_ns_ >= press_ns;
    if (pressed && press_->lid_seated) return go(Step::press_up);
    if (late(press_ns)) fail(cycle, is_down ? code::press_no_seat : code::press_jammed);
    return;
  }
  if (press_->is_up && !press_->is_down) {
    piece_ended_ = true;
    record_ticket_ = cycle.save_retained();
    return go(Step::record_end);
  }
  if (late()) fail(cycle, code::press_jammed);
}

void CellStation::run_end(Cycle& cycle) noexcept {
  if (step_ == Step::record_end) {
    if (cycle.saved(record_ticket_)) {
      publish_piece();
      return go(Step::unclamp);
    }
    if (late()) fail(cycle, code::record_not_saved);
    return;
  }
  if (clamp_is_open && !clamp_is_closed) return go(Step::wait_next);
  if (late()) fail(cycle, code::clamp_jammed);
}

bool CellStation::next_takes() const noexcept {
  if (!next_entry_clear) return false;
  if (!downstream_) return true;
  return downstream_->state.good() && downstream_->ready &&
         downstream_->state == static_cast<std::uint32_t>(StationState::RUNNING);
}

void CellStation::run_wait_next(Cycle& cycle) noexcept {
  const bool takes = next_takes();
  if (pallet_in_transfer && takes && late()) return fail(cycle, code::transfer_occupied);
  if (takes && arm_.clear() && !pallet_in_transfer) {
    cycle.warn(code::next_not_ready, false);
    return go(Step::release);
  }
  cycle.warn(code::next_not_ready, clock_ns_ - entered_ns_ > blocked_after_.get().ns);
  // The piece is done: where it stands now is as good as with the next station, which may be stopping too.
  if (cycle.finishing() && !takes && arm_.resting()) cycle.finished();
}

void CellStation::run_release(Cycle& cycle) noexcept {
  if (step_ == Step::release) {
    if (!pallet_in_position) {
      forget_piece();
      answered_ = 0;
      record_ticket_ = cycle.save_retained();
      return go(Step::close_stopper);
    }
    if (late()) fail(cycle, stopper_is_open ? code::pallet_stuck_in_position : code::stopper_jammed);
    return;
  }
  const bool closed = stopper_is_closed && !stopper_is_open;
  if (closed && cycle.saved(record_ticket_)) return go(Step::wait_pallet);
  if (late()) fail(cycle, closed ? code::record_not_saved : code::stopper_jammed);
}

}  // namespace stationd::programs

// Orders, faults, warnings and events of a station. Scan thread; nothing here allocates or blocks.
#include <algorithm>

#include "scan/codes.hpp"
#include "scan/station.hpp"

namespace stationd {

void Station::enter(StationState state, StopCause cause) noexcept {
  const bool was_driven = driven(state_);
  const bool is_driven = driven(state);
  if (is_driven && !was_driven) started_ = true;
  if (!is_driven) started_ = false;
  if (!is_driven)
    port_.permit.store(false, std::memory_order_release);
  else if (!was_driven)
    port_.permit.store(true, std::memory_order_release);
  *image_.value(running_tag_) = is_driven ? 1 : 0;
  if (was_driven && !is_driven) {  // execute() no longer vouches for its warnings; idle() may raise its own
    for (const Warning& w : warnings_)
      if (w.code != 0) set_warning(w.code, false, w.detail);
    ready_ = false;
  }
  finished_ = false;
  state_ = state;
  cause_ = cause;
}

void Station::fault(std::uint32_t code, std::int64_t detail) noexcept {
  if (state_ == StationState::FAULT) return;
  enter(StationState::FAULT, StopCause::after_fault);
  fault_ = code;
  raise(code, true, detail);
}

void Station::raise(std::uint32_t code, bool active, std::int64_t detail) noexcept {
  report_lost_events();
  if (push_event(code, active, detail)) loss_told_last_ = false;
}

/// As soon as there is room again, before any other event: those cannot keep it out for ever. Where the
/// reader makes room for one at a time they take turns: it does not keep those out either.
void Station::report_lost_events() noexcept {
  const std::uint64_t lost = port_.events.dropped() + port_.runtime_events.dropped();
  if (lost == events_reported_lost_) return;
  const std::size_t room = port_.events.room();
  if (room == 0 || (room == 1 && loss_told_last_)) return;
  events_reported_lost_ = lost;
  loss_told_last_ = push_event(code::events_lost, true, static_cast<std::int64_t>(lost));
}

bool Station::push_event(std::uint32_t code, bool active, std::int64_t detail) noexcept {
  const CodeInfo* info = find_code(code);
  Event event;
  event.seq = port_.event_seq.fetch_add(1, std::memory_order_relaxed) + 1;
  event.code = code;
  event.severity = info != nullptr ? info->severity : Severity::warning;
  event.active = active;
  event.scan = scan_;
  event.utc_ns = utc_ns_;
  event.detail = detail;
  return port_.events.push(event);
}

void Station::set_warning(std::uint32_t code, bool active, std::int64_t detail) noexcept {
  if (code == 0) return;  // marks a free place
  Warning* free_place = nullptr;
  for (Warning& w : warnings_) {
    if (w.code == code) {
      if (!active) {
        w = {};
        raise(code, false, detail);
      }
      return;
    }
    if (w.code == 0 && free_place == nullptr) free_place = &w;
  }
  if (!active || free_place == nullptr) return;
  *free_place = {code, detail};
  raise(code, true, detail);
}

bool Station::service_one() noexcept {
  const Request* oldest = port_.requests.peek();
  if (oldest == nullptr) return false;
  if (oldest->verb == Verb::start && port_.stop.pending()) return false;
  if (oldest->token != 0 && port_.replies.full()) return false;
  Request request;
  port_.requests.pop(request);
  const Reply reply = carry_out(request);
  if (request.token != 0) port_.replies.push(reply);
  return true;
}

Reply Station::carry_out(const Request& request) noexcept {
  Reply reply;
  reply.token = request.token;
  switch (request.verb) {
    case Verb::start: reply = start(request, reply); break;
    case Verb::reset: reply = reset(reply); break;
    case Verb::get:
      reply.value = *image_.value(request.tag);
      reply.quality = *image_.quality(request.tag);
      break;
    case Verb::force: reply = force(request, reply); break;
    case Verb::unforce: reply = unforce(request, reply); break;
    case Verb::unforce_all: reply = unforce_all(reply); break;
    case Verb::set: reply = set(request, reply); break;
    case Verb::tags: copy_image(); break;
  }
  reply.state = state_;
  return reply;
}

Reply Station::start(const Request& request, Reply reply) noexcept {
  reply.outcome = Outcome::refused;
  if (request.order < last_stop_order_) {
    reply.code = code::start_overtaken;
    return reply;
  }
  if (state_ != StationState::STOPPED) {
    if (state_ == StationState::RUNNING)
      reply.outcome = Outcome::done;  // Start is repeated until confirmed
    else
      reply.code = code::start_in_wrong_state;
    return reply;
  }
  for (std::size_t i = 0; i < request.assignment_count; ++i)
    *image_.value(request.assignments[i].tag) = request.assignments[i].value;
  enter(StationState::RUNNING, StopCause::never_started);
  reply.outcome = Outcome::done;
  return reply;
}

Reply Station::reset(Reply reply) noexcept {
  reply.outcome = Outcome::refused;
  if (state_ != StationState::FAULT) {
    reply.code = code::not_in_fault;
    return reply;
  }
  const Cycle cycle(*this, now_ns_);
  if (const std::uint32_t obstacle = program_->reset_obstacle(cycle); obstacle != 0) {
    reply.code = obstacle;
    return reply;
  }
  const std::uint32_t old = fault_;
  fault_ = 0;
  enter(StationState::STOPPED, StopCause::after_fault);
  raise(old, false, 0);
  reply.outcome = Outcome::done;
  return reply;
}

Reply Station::force(const Request& request, Reply reply) noexcept {
  const TagSpec& spec = image_.spec(request.tag);
  const Forces::Taken taken = forceable(spec)
                                  ? forces_.force(request.tag, request.value, spec.area == Area::output)
                                  : Forces::Taken::full;
  if (taken == Forces::Taken::full) {
    reply.outcome = Outcome::refused;
    reply.code = forceable(spec) ? code::forces_full : code::not_forceable;
    return reply;
  }
  reply.changed = taken == Forces::Taken::changed;
  if (reply.changed) raise(code::tag_forced, true, request.tag);
  return reply;
}

Reply Station::unforce(const Request& request, Reply reply) noexcept {
  reply.changed = forces_.release(request.tag);
  reply.value = reply.changed ? 1 : 0;
  if (reply.changed) raise(code::tag_unforced, true, request.tag);
  return reply;
}

Reply Station::unforce_all(Reply reply) noexcept {
  reply.value = forces_.standing();
  reply.changed = reply.value != 0;
  while (forces_.standing() != 0) raise(code::tag_unforced, true, forces_.release_any());
  return reply;
}

Reply Station::set(const Request& request, Reply reply) noexcept {
  if (!image_.spec(request.tag).writable) {
    reply.outcome = Outcome::refused;
    reply.code = code::not_writable;
    return reply;
  }
  reply.value = *image_.value(request.tag);
  reply.changed = reply.value != request.value;
  *image_.value(request.tag) = request.value;
  if (reply.changed) raise(code::tag_set, true, request.tag);
  return reply;
}

// -- Cycle: the program's side ------------------------------------------------------------------------------

std::uint64_t Cycle::scan() const noexcept { return station_.scan_; }
std::uint32_t Cycle::epoch() const noexcept { return station_.options_.epoch; }
Restart Cycle::restart() const noexcept { return station_.restart_; }
StationState Cycle::state() const noexcept { return station_.state_; }
bool Cycle::started() const noexcept { return station_.started_; }
bool Cycle::finishing() const noexcept { return station_.state_ == StationState::STOPPING; }
void Cycle::finished() noexcept { station_.finished_ = finishing(); }

void Cycle::fault(std::uint32_t code, std::int64_t detail) noexcept {
  if (station_.pending_fault_ != 0) return;
  station_.pending_fault_ = code;
  station_.pending_detail_ = detail;
}

void Cycle::warn(std::uint32_t code, bool active, std::int64_t detail) noexcept {
  station_.set_warning(code, active, detail);
}

void Cycle::note(std::uint32_t code, std::int64_t detail) noexcept { station_.raise(code, true, detail); }

void Cycle::report(std::uint32_t step, std::uint32_t piece, bool ready) noexcept {
  station_.step_ = step;
  station_.piece_ = piece;
  station_.ready_ = ready;
}

std::uint64_t Cycle::save_retained() noexcept {
  station_.retain_urgent_ = station_.scan_;
  return station_.scan_;
}

bool Cycle::saved(std::uint64_t ticket) const noexcept {
  return station_.retain_->saved_scan.load(std::memory_order_acquire) >= ticket;
}

}  // namespace stationd

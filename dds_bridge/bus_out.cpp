#include "dds_bridge/bus_out.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "dds_bridge/values.hpp"
#include "scan/clock.hpp"
#include "scan/codes.hpp"

namespace stationd::bus {
namespace {

constexpr std::int64_t kStalled = 500'000'000;

/// What an observer waits for: a change of it is sent at once.
bool same(const StatusRecord& a, const StatusRecord& b) {
  return a.state == b.state && a.cause == b.cause && a.ready == b.ready && a.epoch == b.epoch &&
         a.fault == b.fault && a.warning == b.warning && a.step == b.step && a.piece == b.piece &&
         a.forced == b.forced;
}

/// Of a station whose scan hangs: what it will say itself when it goes on.
StatusRecord of_hung(StatusRecord record) {
  if (record.state == StationState::FAULT) return record;
  record.state = StationState::FAULT;
  record.fault = code::watchdog;
  record.ready = false;
  return record;
}

/// The device or the remote station that was lost or is back, the tag that an operator changed; empty for
/// any other event.
std::string source_of(Station& station, const Event& event) {
  if (event.code == code::tag_forced || event.code == code::tag_unforced || event.code == code::tag_set)
    return station.image().spec(static_cast<TagIndex>(event.detail)).name;
  if (event.code != code::device_lost && event.code != code::remote_lost) return {};
  const auto& links = event.code == code::device_lost ? station.device_inputs() : station.bus_inputs();
  const auto index = static_cast<std::size_t>(event.detail);
  return index < links.size() ? links[index]->source : std::string();
}

/// "field device lost: remote-io-1"
std::string text_of(Station& station, const Event& event) {
  const CodeInfo* info = find_code(event.code);
  if (info == nullptr) return code_id(event.code);
  const std::string source = source_of(station, event);
  return clipped(std::string(info->name) + (source.empty() ? "" : ": ") + source, kTextBound);
}

}  // namespace

BusOut::BusOut(Context& context, EventWriter& events) : context_(context), events_(events) {
  for (const auto& entry : context_.stations) {
    Out out{.entry = entry.get(), .pvs = {}, .said = {}, .record = {}, .status = {}};
    for (const auto& link : entry->station->pvs()) out.pvs.push_back(make_pv(*entry->station, *link));
    outs_.push_back(std::move(out));
  }
}

BusOut::Pv BusOut::make_pv(const Station& station, PvLink& link) const {
  const std::string what = "station " + station.name() + ", PV " + link.topic;
  const TopicInfo* info = find_topic(link.topic);
  if (info == nullptr || info->service != Service::pv || info->id == TopicId::status) {
    throw BusError(what + ": a station publishes Set or End");
  }
  auto maps = map_fields(*info->type, link.members, link.tags, station.image(), false, what);
  return {&link, info, std::move(maps), Object(*info->type)};
}

std::vector<std::string> BusOut::topics() const {
  std::vector<std::string> names;
  for (const Out& out : outs_) {
    for (const Pv& pv : out.pvs) {
      const std::string name(pv.topic->name);
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

/// In the order of the paper's priorities: events of all stations, then PVs, then replies.
void BusOut::pass(std::int64_t now_ns) {
  if (!context_.quiet()) {  // a duplicate's events would carry another's (STATION, EPOCH, SEQ)
    for (Out& out : outs_) send_events(out);
  }
  for (Out& out : outs_) {
    send_pvs(out);
    send_status(out, now_ns);
  }
  for (Out& out : outs_) send_replies(out);
}

void BusOut::farewell() {
  for (Out& out : outs_) {
    if (out.record_ns == 0 || context_.quiet()) continue;
    out.record.ready = false;
    fill_status(out);
    context_.bus.write(out.status);
  }
}

/// The scan's and the watchdog's, in the order of their numbers.
void BusOut::send_events(Out& out) {
  StationPort& port = out.entry->station->port();
  while (true) {
    const Event* scan = port.events.peek();
    const Event* watchdog = port.runtime_events.peek();
    if (scan == nullptr && watchdog == nullptr) return;
    const bool first = watchdog == nullptr || (scan != nullptr && scan->seq < watchdog->seq);
    Event event;
    (first ? port.events : port.runtime_events).pop(event);
    send_event(*out.entry->station, event);
  }
}

void BusOut::send_event(Station& station, const Event& event) {
  Gse gse;
  gse.ERROR = event.active && event.severity != Severity::info;
  gse.STATUS = event.code;
  gse.STATION = station.name();
  gse.EPOCH = station.epoch();
  gse.SEQ = event.seq;
  gse.SEVERITY = static_cast<std::uint32_t>(event.severity);
  gse.ACTIVE = event.active;
  gse.EDGE = event.edge;
  gse.SOURCE_TIME = event.utc_ns;
  gse.DETAIL = event.detail;
  gse.TEXT = text_of(station, event);
  events_.put(std::move(gse));
}

void BusOut::send_pvs(Out& out) {
  for (Pv& pv : out.pvs) {
    if (!pv.link->blocks.update() || context_.quiet()) continue;
    const ConstBlockView block{pv.link->blocks.readable(), pv.link->tags.layout};
    void* object = pv.object.data;
    const Slot* slots = block.slots().data();
    if (pv.topic->id == TopicId::set)
      send_pv(pv, *out.entry->station, slots, *static_cast<Set*>(object));
    else
      send_pv(pv, *out.entry->station, slots, *static_cast<End*>(object));
  }
}

template <class T> void BusOut::send_pv(const Pv& pv, const Station& station, const Slot* slots, T& message) {
  message = T{};
  message.STATION = station.name();
  message.EPOCH = station.epoch();  // unless the program has a member for it
  for (const FieldMap& map : pv.maps) store(map, slots, &message);
  context_.bus.write(message);
}

void BusOut::send_status(Out& out, std::int64_t now_ns) {
  StationPort& port = out.entry->station->port();
  const bool hung = port.hung.load(std::memory_order_acquire);
  const bool first = out.record_ns == 0;
  const StatusRecord before = out.record;
  const bool taken = port.status.take(out.said);
  if (taken) out.record_ns = now_ns;
  if (out.record_ns == 0) return;
  if (taken || hung) {
    out.record = hung ? of_hung(out.said) : out.said;
    if (!first && (before.state != out.record.state || before.fault != out.record.fault))
      say_state(out, before, now_ns);
    if (first || !same(before, out.record)) out.sent_ns = 0;  // at once
  }
  if (out.sent_ns != 0 && now_ns - out.sent_ns < context_.options.status_period_ns) return;
  // A scan that says nothing any more is not spoken for, unless the watchdog does: its observers shall see it
  // go stale.
  const bool silent = now_ns - out.record_ns > std::max(kStalled, 3 * out.status.PERIOD_NS);
  if (out.sent_ns != 0 && silent && !hung) return;
  fill_status(out);
  out.sent_ns = now_ns;
  if (!context_.quiet()) context_.bus.write(out.status);
}

/// So that the log alone tells what a station did, without a supervisor that listens.
void BusOut::say_state(const Out& out, const StatusRecord& before, std::int64_t now_ns) const {
  const StatusRecord& is = out.record;
  std::string text = out.entry->station->name() + ": " + std::string(name_of(before.state)) + " -> " +
                     std::string(name_of(is.state));
  if (is.fault != 0) text += ", " + code_with_name(is.fault);
  const int severity = is.state == StationState::FAULT ? 2 : 1;
  context_.log.say("state" + out.entry->station->name() + std::to_string(is.fault), severity, text, now_ns);
}

void BusOut::fill_status(Out& out) {
  Station& station = *out.entry->station;
  const StatusRecord& record = out.record;
  const TaskFigures figures = out.entry->figures ? out.entry->figures() : TaskFigures{};
  Status& status = out.status;
  status.STATION = station.name();
  status.STATE = static_cast<std::uint32_t>(record.state);
  status.EPOCH = record.epoch;
  status.READY = record.ready;
  status.FAULT = record.fault;
  status.CONTROLLER = clipped(context_.options.controller, kNameBound);
  status.SCANS = record.scan;
  status.DEADLINE_MISSES = record.deadline_misses;
  status.WARNING = record.warning;
  status.STOP_CAUSE = static_cast<std::uint32_t>(record.cause);
  status.STEP = record.step;
  status.STEP_NAME = clipped(station.program().step_name(record.step), kTextBound);
  status.PIECE = record.piece;
  status.PERIOD_NS = figures.period_ns;
  status.LATENESS_P99_NS = figures.lateness_p99_ns;
  status.LATENESS_MAX_NS = figures.lateness_max_ns;
  status.REALTIME = clipped(figures.realtime, kTextBound);
  status.SOURCE_TIME = record.utc_ns;
  status.FORCED = record.forced;
  const std::lock_guard lock(out.entry->mutex);
  out.entry->status = status;
}

void BusOut::send_replies(Out& out) {
  Reply reply;
  while (out.entry->station->port().replies.pop(reply)) {
    if (const auto pending = context_.pending.take(reply.token)) settle(*pending, reply);
  }
}

/// A Start is logged if it was refused, and answered if it has an id to answer to.
void BusOut::settle_start(const Pending& pending, const Reply& reply) {
  const std::string name = pending.entry->station->name();
  if (reply.outcome != Outcome::done) {
    const std::string why = "refused: " + code_with_name(reply.code);
    const std::string from = pending.body.from.empty() ? "" : " from " + pending.body.from;
    context_.log.say("start" + name, 1, name + ": Start" + from + " " + why, monotonic_ns());
    if (!pending.body.id.empty()) context_.reply(pending.body, pending.origin, 0, reply.code, "Start " + why);
  } else if (reply.code == 0) {
    const std::lock_guard lock(pending.entry->mutex);
    for (std::size_t i = 0; i < pending.request.assignment_count; ++i) {
      pending.entry->changes.set[pending.request.assignments[i].tag] = pending.request.assignments[i].value;
    }
  }
}

/// Takes over what was done about tags, logs each change, and says what the answer is.
std::string BusOut::settle_tags(const Pending& pending, const Reply& reply) const {
  BridgedEntry& entry = *pending.entry;
  const Image& image = entry.station->image();
  const std::string from = pending.body.from.empty() ? "(unnamed)" : pending.body.from;
  const std::lock_guard lock(entry.mutex);
  for (const std::string& line : take_change(image, pending.request, reply, entry.changes))
    context_.log.say_each(2, entry.station->name() + ": " + line + ", from=" + from);
  if (pending.request.verb != Verb::tags) return tag_answer(image, pending.request, reply, entry.changes);
  ImageCopy& copy = entry.station->image_copy();
  copy.blocks.update();
  const std::size_t room = context_.bus.options().max_body_bytes - reply_prefix(pending.body).size();
  return tags_answer(image, pending.request, {copy.blocks.readable(), copy.tags.layout}, entry.changes, room);
}

/// What became of a request.
void BusOut::settle(const Pending& pending, const Reply& reply) {
  if (pending.request.verb == Verb::start) return settle_start(pending, reply);
  const std::uint32_t refusal = reply.outcome == Outcome::done ? 0 : reply.code;
  const std::string name = pending.entry->station->name();
  std::string text = refusal == 0 ? settle_tags(pending, reply) : "refused: " + code_with_name(refusal);
  if (refusal != 0 && pending.request.verb != Verb::reset) {
    context_.counters.orders_refused.fetch_add(1, std::memory_order_relaxed);
    context_.log.say("Msg" + name, 2, name + ": " + pending.body.words[0] + " " + text, monotonic_ns());
  }
  if (pending.request.verb != Verb::tags) text.append(" state=").append(name_of(reply.state));
  context_.reply(pending.body, pending.origin, 0, refusal, text);
}

}  // namespace stationd::bus

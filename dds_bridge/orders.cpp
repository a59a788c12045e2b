#include "dds_bridge/orders.hpp"

#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include "dds_bridge/histogram_body.hpp"
#include "dds_bridge/tag_orders.hpp"
#include "dds_bridge/values.hpp"
#include "scan/clock.hpp"
#include "scan/codes.hpp"

namespace stationd::bus {
namespace {

/// The parameters of a Start; the problem, if there is one, with its code.
struct Assigned {
  std::uint32_t code = 0;
  std::string problem;
};

Assigned assign(const Image& image, const Body& body, Request& request) {
  if (body.pairs.size() > Request::kMaxAssignments) {
    return {code::body_invalid,
            "at most " + std::to_string(Request::kMaxAssignments) + " parameters at once"};
  }
  for (const auto& [key, text] : body.pairs) {
    const auto tag = image.find(key);
    if (!tag || !image.spec(*tag).parameter) return {code::unknown_tag, "there is no parameter " + key};
    const ParsedValue value = parse_value(image.spec(*tag), text);
    if (!value.problem.empty()) return {code::value_invalid, key + ": " + value.problem};
    request.assignments[request.assignment_count++] = {*tag, value.slot};
  }
  return {};
}

std::optional<std::uint32_t> code_number(std::string_view text) {
  if (text.starts_with("ST") || text.starts_with("st")) text.remove_prefix(2);
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

constexpr const char* kVerbs =
    "say status, describe CODE, get TAG, tags [TAG], force TAG VALUE, unforce TAG|all, set TAG VALUE, "
    "params, "
    "histogram FIGURE [last_minute] or reset";

const char* name_of(Order order) {
  switch (order) {
    case Order::START: return "START";
    case Order::STOP: return "STOP";
    case Order::MSG: return "MSG";
  }
  return "?";
}

}  // namespace

void Orders::refuse(const char* what, const MsgReq& order, const Body& body, std::uint32_t code,
                    const std::string& why) {
  context_.counters.orders_refused.fetch_add(1, std::memory_order_relaxed);
  const std::string from = body.from.empty() ? "" : " from " + body.from;
  context_.log.say(std::string(what) + order.DEST_STATION, 2,
                   order.DEST_STATION + ": " + what + from + " refused: " + why + ", " + code_with_name(code),
                   monotonic_ns());
}

void Orders::on_stop(const MsgReq& order, const Origin& origin) {
  BridgedEntry* entry = context_.find(order.DEST_STATION);
  if (entry == nullptr || context_.closed.load()) return;
  const Body body = parse_body(order.BODY, context_.bus.options().max_body_bytes);
  if (order.ORDER != Order::STOP) {
    refuse("Stop", order, body, code::order_refused, std::string("ORDER is ") + name_of(order.ORDER));
    return;
  }
  if (!body.ok()) return refuse("Stop", order, body, code::body_invalid, body.problem);
  if (!body.words.empty()) return refuse("Stop", order, body, code::body_invalid, "it takes mode=... alone");
  StopMode mode = StopMode::immediate;
  for (const auto& [key, value] : body.pairs) {
    if (key != "mode") return refuse("Stop", order, body, code::unknown_tag, "Stop has no parameter " + key);
    if (value == "end_of_piece")
      mode = StopMode::end_of_piece;
    else if (value != "immediate") {
      return refuse("Stop", order, body, code::value_invalid,
                    "mode is immediate or end_of_piece, not " + value);
    }
  }
  entry->station->port().stop.set(mode, origin.order);
}

void Orders::on_start(const MsgReq& order, const Origin& origin) {
  BridgedEntry* entry = context_.find(order.DEST_STATION);
  if (entry == nullptr || context_.quiet() || context_.closed.load()) return;
  const Body body = parse_body(order.BODY, context_.bus.options().max_body_bytes);
  const auto refused = [&](std::uint32_t code, const std::string& problem) {
    refuse("Start", order, body, code, problem);
    if (!body.id.empty()) context_.reply(body, origin, 0, code, problem);
  };
  if (order.ORDER != Order::START)
    return refused(code::order_refused, std::string("ORDER is ") + name_of(order.ORDER));
  if (!body.ok()) return refused(code::body_invalid, body.problem);
  if (!body.words.empty())
    return refused(code::body_invalid, "it takes parameter=value, not " + body.words[0]);
  Request request;
  request.verb = Verb::start;
  request.order = origin.order;
  const Assigned assigned = assign(entry->station->image(), body, request);
  if (assigned.code != 0) return refused(assigned.code, assigned.problem);
  const Answer answer = to_scan(*entry, body, origin, request);
  if (!answer.later) {
    context_.log.say("busy" + order.DEST_STATION, 2,
                     order.DEST_STATION + ": Start not taken, " + code_with_name(code::busy), monotonic_ns());
  }
}

void Orders::on_request(const MsgReq& request, const Origin& origin) {
  BridgedEntry* entry = context_.find(request.DEST_STATION);
  if (entry == nullptr || context_.quiet() || context_.closed.load()) return;
  const Body body = parse_body(request.BODY, context_.bus.options().max_body_bytes);
  Answer said;
  if (request.ORDER != Order::MSG) {
    said = {std::string("ORDER is ") + name_of(request.ORDER), code::order_refused};
  } else if (!body.ok()) {
    said = {body.problem, code::body_invalid};
  } else {
    said = answer(*entry, body, origin);
  }
  if (said.later) return;
  if (said.refusal != 0 && said.refusal != code::busy) {
    refuse("Msg", request, body, said.refusal, said.text);
  }
  context_.reply(body, origin, said.code, said.refusal, said.text);
}

Orders::Answer Orders::answer(BridgedEntry& entry, const Body& body, const Origin& origin) {
  if (!body.pairs.empty()) return {"a request has no " + body.pairs[0].first + "=", code::body_invalid};
  if (body.words.empty()) return {kVerbs, code::unknown_verb};
  const std::string& verb = body.words[0];
  const std::size_t arguments = body.words.size() - 1;
  if (verb == "histogram") return histogram(entry, body);
  if (is_tag_verb(verb)) {
    CheckedOrder order = check_tag_order(entry.station->image(), body);
    if (order.refusal != 0) return {std::move(order.problem), order.refusal};
    return to_scan(entry, body, origin, order.request);
  }
  const bool takes_one = verb == "describe";
  if (!takes_one && verb != "status" && verb != "reset" && verb != "params") {
    return {verb + ": not a verb; " + kVerbs, code::unknown_verb};
  }
  if (arguments != (takes_one ? 1U : 0U)) {
    return {verb + (takes_one ? " takes one argument" : " takes no argument"), code::body_invalid};
  }
  if (verb == "describe") return describe(body);
  if (verb == "status") return status(entry);
  if (verb == "params") return params(entry);
  Request request;
  request.verb = Verb::reset;
  return to_scan(entry, body, origin, request);
}

Orders::Answer Orders::to_scan(BridgedEntry& entry, const Body& body, const Origin& origin, Request request) {
  Pending pending;
  pending.entry = &entry;
  pending.origin = origin;
  pending.body = body;
  context_.pending.add(std::move(pending), request);
  if (entry.station->port().requests.push(request)) return {.text = {}, .later = true};
  static_cast<void>(context_.pending.take(request.token));
  context_.counters.orders_busy.fetch_add(1, std::memory_order_relaxed);
  return {"busy: ask again later", code::busy};
}

Orders::Answer Orders::status(BridgedEntry& entry) {
  const std::lock_guard lock(entry.mutex);
  if (!entry.status) return {"the station has not scanned yet", code::busy};
  const Status& s = *entry.status;
  std::string text = "station=" + s.STATION;
  text.append(" state=").append(stationd::name_of(static_cast<StationState>(s.STATE)));
  text += " ready=" + std::string(s.READY ? "true" : "false") + " epoch=" + std::to_string(s.EPOCH);
  text += " step=" + (s.STEP_NAME.empty() ? std::to_string(s.STEP) : s.STEP_NAME);
  text += " piece=" + std::to_string(s.PIECE) + " scans=" + std::to_string(s.SCANS);
  text += " deadline_misses=" + std::to_string(s.DEADLINE_MISSES);
  text += " fault=" + (s.FAULT == 0 ? "none" : code_id(s.FAULT));
  text += " warning=" + (s.WARNING == 0 ? "none" : code_id(s.WARNING));
  text += " forced=" + std::to_string(s.FORCED) + " controller=" + s.CONTROLLER;
  return {std::move(text), 0, s.FAULT};
}

Orders::Answer Orders::describe(const Body& body) {
  const auto number = code_number(body.words[1]);
  if (!number) return {body.words[1] + " is no code: ST1203 or 1203, say", code::body_invalid};
  const CodeInfo* info = find_code(*number);
  if (info == nullptr) return {"there is no code " + code_id(*number), code::value_invalid, *number};
  std::string text = code_id(*number) + " " + std::string(info->name) + " (";
  text.append(stationd::name_of(info->severity)).append("). Cause: ").append(info->cause);
  text.append(" Remedy: ").append(info->remedy);
  return {std::move(text), 0, *number};
}

Orders::Answer Orders::params(BridgedEntry& entry) {
  const Image& image = entry.station->image();
  const std::lock_guard lock(entry.mutex);
  std::string text;
  for (TagIndex tag = 0; tag < image.size(); ++tag) {
    const TagSpec& spec = image.spec(tag);
    if (!spec.parameter) continue;
    const auto set = entry.changes.set.find(tag);
    const Slot value = set == entry.changes.set.end() ? spec.initial : set->second;
    const std::string range = format_range(spec);
    if (!text.empty()) text += '\n';
    text += spec.name + "=" + format_value(spec.type, value) + (range.empty() ? "" : " (" + range + ")");
  }
  return {text.empty() ? "no parameters" : std::move(text)};
}

Orders::Answer Orders::histogram(BridgedEntry& entry, const Body& body) const {
  const std::vector<std::string>& words = body.words;
  const bool window_known = words.size() == 3 && (words[2] == stationd::name_of(Window::last_minute) ||
                                                  words[2] == stationd::name_of(Window::since_start));
  if (words.size() != 2 && !window_known)
    return {"histogram takes a figure, and last_minute if it is meant", code::body_invalid};
  const std::optional<Figure> figure = find_figure(words[1]);
  if (!figure) {
    std::string known;
    for (std::size_t i = 0; i < kFigures; ++i)
      known.append(i == 0 ? "" : ", ").append(stationd::name_of(static_cast<Figure>(i)));
    return {"there is no figure " + words[1] + "; there are " + known, code::value_invalid};
  }
  if (!entry.histogram) return {"the station keeps no statistics", code::busy};
  const bool minute = window_known && words[2] == stationd::name_of(Window::last_minute);
  HistogramBody said{*figure, minute ? Window::last_minute : Window::since_start, 1, {}};
  said.buckets = entry.histogram(said.figure, said.window);
  const std::size_t room = context_.bus.options().max_body_bytes - reply_prefix(body).size();
  return {histogram_text(std::move(said), room)};
}

}  // namespace stationd::bus

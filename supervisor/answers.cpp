#include "supervisor/answers.hpp"

#include <charconv>
#include <vector>

#include "dds_bridge/body.hpp"
#include "dds_bridge/text.hpp"
#include "scan/codes.hpp"

namespace stationd::supervisor {
namespace {

using bus::code_id;
using bus::printable;
using bus::short_duration;
using bus::state_text;

using Words = std::vector<std::string>;

constexpr std::size_t kMaxBodyBytes = 8192;

constexpr std::string_view kHelp =
    "describe CODE: what a code means, its cause and remedy | status STATION: what is known of a station | "
    "status: of all | pieces: counts by station | role: whether this supervisor commands | help";

struct Answer {
  std::string text;
  std::uint32_t refusal = 0;  ///< code; 0: answered
  std::uint32_t code = 0;     ///< what it is about
};

Answer refused(std::uint32_t code, std::string text) { return {std::move(text), code, 0}; }

Answer describe(const Words& words) {
  if (words.size() != 2)
    return refused(code::body_invalid, "describe takes one code, such as ST1203 or 1203");
  std::string_view digits = words[1];
  if (digits.starts_with("ST") || digits.starts_with("st")) digits.remove_prefix(2);
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc{} || end != digits.data() + digits.size())
    return refused(code::body_invalid, "not a code: " + printable(words[1]) + "; codes look like ST1203");
  const CodeInfo* info = find_code(number);
  if (info == nullptr) return refused(code::value_invalid, "no such code: " + code_id(number));
  std::string text =
      code_id(number) + " " + std::string(info->name) + " (" + std::string(name_of(info->severity));
  text += "). Cause: " + std::string(info->cause) + " Remedy: " + std::string(info->remedy);
  return {std::move(text), 0, number};
}

std::string status_of(const Model& model, const StationRecord& station, std::int64_t now_ns) {
  std::string out = "station=" + printable(station.name);
  if (model.away(station, now_ns)) {
    out += " state=away";
  } else {
    out += " state=" + state_text(station.status->STATE);
  }
  out += " intent=" + std::string(name_of(station.intent));
  if (station.status) {
    const bus::Status& s = *station.status;
    out += " epoch=" + std::to_string(s.EPOCH) + " ready=" + (s.READY ? "true" : "false");
    out += " step=" + (s.STEP_NAME.empty() ? std::to_string(s.STEP) : printable(s.STEP_NAME));
    out += " piece=" + std::to_string(s.PIECE) + " scans=" + std::to_string(s.SCANS);
    out += " deadline_misses=" + std::to_string(s.DEADLINE_MISSES);
    out += " fault=" + (s.FAULT == 0 ? "none" : code_id(s.FAULT));
    out += " warning=" + (s.WARNING == 0 ? "none" : code_id(s.WARNING));
    out += " controller=" + printable(s.CONTROLLER);
    out += " age=" + short_duration(now_ns - station.seen_ns);
  }
  out += station.configured ? " configured=true" : " configured=false";
  out += " pieces=" + std::to_string(station.pieces.finished());
  return out;
}

Answer status(const Model& model, const Words& words, std::int64_t now_ns) {
  if (words.size() > 2) return refused(code::body_invalid, "status takes one station, or none for all");
  if (words.size() == 2) {
    const StationRecord* station = model.station(words[1]);
    if (station == nullptr) return refused(code::value_invalid, "no such station: " + printable(words[1]));
    return {status_of(model, *station, now_ns)};
  }
  std::string out;
  for (const StationRecord& station : model.stations()) {
    if (!out.empty()) out += '\n';
    out += status_of(model, station, now_ns);
  }
  return {std::move(out)};
}

Answer pieces(const Model& model) {
  std::string out = "pieces=" + std::to_string(model.pieces()) + " counted_at=" + model.count_at();
  for (const StationRecord& station : model.stations()) {
    const PieceCount& count = station.pieces;
    out += "\nstation=" + printable(station.name) + " counted=" + std::to_string(count.counted);
    out += " missed=" + std::to_string(count.missed) + " faulty=" + std::to_string(count.faulty);
  }
  return {std::move(out)};
}

Answer answer_words(const Model& model, const Words& words, std::int64_t now_ns) {
  if (words.empty()) return refused(code::unknown_verb, "empty request; known: " + std::string(kHelp));
  if (words[0] == "describe") return describe(words);
  if (words[0] == "status") return status(model, words, now_ns);
  if (words[0] == "pieces") return pieces(model);
  if (words[0] == "help") return {std::string(kHelp)};
  if (words[0] == "role") return {model.role() == Role::commanding ? "role=commanding" : "role=observing"};
  return refused(code::unknown_verb,
                 "unknown verb " + printable(words[0]) + "; known: " + std::string(kHelp));
}

}  // namespace

bus::MsgRes answer(const Model& model, const bus::MsgReq& request, std::int64_t now_ns) {
  const bus::Body body = bus::parse_body(request.BODY, kMaxBodyBytes);
  Answer said;
  if (request.ORDER != bus::Order::MSG) {
    said = refused(code::order_refused, "this topic takes ORDER MSG alone");
  } else if (!body.ok()) {
    said = refused(code::body_invalid, body.problem);
  } else {
    said = answer_words(model, body.words, now_ns);
  }
  bus::MsgRes reply;
  reply.DEST_STATION = body.from;
  reply.CODE = said.code;
  reply.ERROR = said.refusal != 0;
  reply.STATUS = said.refusal;
  reply.BODY = bus::clipped(bus::reply_prefix(body) + said.text, kMaxBodyBytes);
  return reply;
}

}  // namespace stationd::supervisor

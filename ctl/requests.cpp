// msg and reset: questions that a station or the supervisor answers (RR).
#include "ctl/requests.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "ctl/client.hpp"
#include "ctl/commands.hpp"
#include "ctl/output.hpp"
#include "ctl/replies.hpp"
#include "dds_bridge/text.hpp"
#include "scan/clock.hpp"
#include "scan/messages.hpp"

namespace stationd::ctl {
namespace {

using bus::printable;

constexpr std::int64_t kRepeat_ns = 500'000'000;

/// Asking twice does no harm: a request is lost if it is written before the other side's reader was matched.
bool may_repeat(const std::string& text) {
  static constexpr auto verbs = std::to_array<std::string_view>(
      {"status", "describe", "get", "tags", "params", "histogram", "pieces", "help", "role", "reset"});
  const std::string verb = text.substr(0, text.find(' '));
  return std::ranges::find(verbs, verb) != verbs.end();
}

}  // namespace

std::optional<bus::MsgRes> ask(Client& client, const Arguments& arguments, const std::string& text) {
  const std::int64_t until_ns = monotonic_ns() + arguments.timeout_ns;
  const std::string id = client.new_id();
  const bus::MsgReq request{arguments.station, client.addressed(text, id), bus::Order::MSG};
  // The supervisor publishes no Status; a station that does is matched at about the time its Status comes.
  client.wait(std::min(until_ns, monotonic_ns() + kRepeat_ns),
              [&] { return client.seen().contains(arguments.station); });
  std::optional<bus::MsgRes> answer;
  const auto answered = [&] {
    if (const bus::MsgRes* reply = client.reply_to(id)) answer = *reply;
    return answer.has_value();
  };
  if (!may_repeat(text))
    client.wait(std::min(until_ns, monotonic_ns() + kRepeat_ns / 2), [] { return false; });
  client.bus().write_request(request);
  while (!client.wait(std::min(until_ns, monotonic_ns() + kRepeat_ns), answered) && monotonic_ns() < until_ns)
    if (may_repeat(text)) client.bus().write_request(request);
  return answer;
}

namespace {

/// `params` has the range behind each value: "speed=3 (1..1000)".
std::string without_ranges(const std::string& body) {
  std::string out;
  for (std::size_t at = 0; at < body.size();) {
    const std::size_t end = std::min(body.find('\n', at), body.size());
    const std::string line = body.substr(at, end - at);
    out += line.substr(0, line.find(" (")) + "\n";
    at = end + 1;
  }
  return out;
}

}  // namespace

int show(const Arguments& arguments, const bus::MsgRes& reply, const Say& say) {
  const std::string text = without_id(reply.BODY);
  if (arguments.json) {
    JsonObject out;
    out.text("station", arguments.station).flag("ok", !reply.ERROR).flag("error", reply.ERROR);
    out.number("status", reply.STATUS).number("code", reply.CODE).text("body", text);
    if (!arguments.text.starts_with("histogram"))  // whose buckets are no pairs; `stats` has them as JSON
      add_values(out, arguments.text == "params" ? without_ranges(text) : text);
    print_line(out.str());
  } else if (!reply.ERROR) {
    const std::string line = say ? say(text) : printable(text, true);
    print_line(line.empty() ? "done" : line);
  }
  if (!reply.ERROR) return kDone;
  std::fprintf(stderr, "stationctl: %s refused: %s\n", printable(arguments.station).c_str(),
               refusal_text(reply).c_str());
  return kRefused;
}

int fail_unanswered(const Arguments& arguments, Client& client) {
  const Stations stations = client.stations();
  if (!stations.contains(arguments.station) && arguments.station != "supervisor")
    return fail(arguments, kNoStation, no_station_text(arguments, stations));
  return fail(arguments, kNoAnswer, no_answer_text(arguments, "did not answer", stations));
}

int ask_and_show(const Arguments& arguments, const std::string& text, const Say& say) {
  Client client(arguments);
  if (const std::optional<bus::MsgRes> reply = ask(client, arguments, text))
    return show(arguments, *reply, say);
  return fail_unanswered(arguments, client);
}

namespace {

/// What became of one station's reset, as a line and as JSON.
int show_reset(const Arguments& about, const std::optional<bus::MsgRes>& reply, const Stations& stations,
               std::vector<std::string>& values) {
  const int status = !reply ? kNoAnswer : reply->ERROR ? kRefused : kDone;
  const std::vector<Pairs> lines = reply ? pairs_of(without_id(reply->BODY)) : std::vector<Pairs>{};
  const std::string* state = lines.empty() ? nullptr : find_value(lines.front(), "state");
  std::string text = state == nullptr ? "reset" : printable(*state);
  if (status == kRefused) text = refusal_text(*reply);
  if (status == kNoAnswer) text = no_answer_text(about, "did not answer", stations);
  JsonObject out;
  out.text("station", about.station).flag("ok", status == kDone);
  values.push_back(out.text("state", state == nullptr ? "" : *state).text("message", text).str());
  if (status == kDone && !about.json) print_line(printable(about.station) + " " + text);
  if (status == kRefused) text = printable(about.station) + " refused reset: " + text;
  if (status != kDone) std::fprintf(stderr, "stationctl: %s\n", text.c_str());
  return status;
}

/// Of every station in FAULT; the others have nothing to acknowledge.
int reset_all(const Arguments& arguments) {
  Client client(arguments);
  const Stations stations = client.settle(monotonic_ns() + arguments.timeout_ns);
  if (stations.empty()) return fail(arguments, kNoStation, no_station_text(arguments, stations));
  int status = kDone;
  std::vector<std::string> values;
  for (const auto& [name, seen] : stations) {
    if (seen.status.STATE != static_cast<std::uint32_t>(StationState::FAULT)) continue;
    Arguments about = arguments;
    about.station = name;
    status = std::max(status, show_reset(about, ask(client, about, "reset"), client.stations(), values));
  }
  if (arguments.json) {
    JsonObject out;
    out.text("command", "reset").flag("ok", status == kDone);
    print_line(out.raw("stations", json_array(values)).str());
  } else if (values.empty()) {
    print_line("no station is in FAULT: nothing to reset");
  }
  return status;
}

}  // namespace

int msg(const Arguments& arguments) { return ask_and_show(arguments, arguments.text); }

int reset(const Arguments& arguments) {
  return arguments.station == "all" ? reset_all(arguments) : ask_and_show(arguments, "reset");
}

}  // namespace stationd::ctl

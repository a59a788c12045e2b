// msg and reset: questions that a station or the supervisor answers (RR).
#include "ctl/requests.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "ctl/client.hpp"
#include "ctl/commands.hpp"
#include "ctl/output.hpp"
#include "dds_bridge/text.hpp"
#include "scan/clock.hpp"

namespace stationd::ctl {
namespace {

using bus::code_id;
using bus::code_text;
using bus::printable;

constexpr std::int64_t kRepeat_ns = 500'000'000;

/// Asking twice does no harm: a request is lost if it is written before the other side's reader was matched.
bool may_repeat(const std::string& text) {
  static constexpr auto verbs = std::to_array<std::string_view>(
      {"status", "describe", "get", "params", "histogram", "pieces", "help", "role", "reset"});
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

std::string without_id(const std::string& body) {
  if (!body.starts_with("id=")) return body;
  const std::size_t blank = body.find(' ');
  return blank == std::string::npos ? "" : body.substr(blank + 1);
}

namespace {

int show(const Arguments& arguments, const bus::MsgRes& reply) {
  const std::string text = without_id(reply.BODY);
  if (arguments.json) {
    JsonObject out;
    out.text("station", arguments.station).flag("ok", !reply.ERROR).flag("error", reply.ERROR);
    print_line(out.number("status", reply.STATUS).number("code", reply.CODE).text("body", text).str());
  } else if (!reply.ERROR) {
    print_line(text.empty() ? "done" : printable(text, true));
  }
  if (!reply.ERROR) return kDone;
  std::string why = printable(text.starts_with("refused: ") ? text.substr(9) : text);
  if (reply.STATUS != 0 && why.find(code_id(reply.STATUS)) == std::string::npos)
    why += (why.empty() ? "" : " (") + code_text(reply.STATUS) + (why.empty() ? "" : ")");
  std::fprintf(stderr, "stationctl: %s refused: %s\n", arguments.station.c_str(), why.c_str());
  return kRefused;
}

int ask_and_show(const Arguments& arguments, const std::string& text) {
  Client client(arguments);
  if (const std::optional<bus::MsgRes> reply = ask(client, arguments, text)) return show(arguments, *reply);
  const Stations stations = client.stations();
  if (!stations.contains(arguments.station) && arguments.station != "supervisor")
    return fail(arguments, kNoStation, no_station_text(arguments, stations));
  return fail(arguments, kNoAnswer, no_answer_text(arguments, "did not answer", stations));
}

}  // namespace

int msg(const Arguments& arguments) { return ask_and_show(arguments, arguments.text); }

int reset(const Arguments& arguments) { return ask_and_show(arguments, "reset"); }

}  // namespace stationd::ctl

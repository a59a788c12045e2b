// start and stop: orders (RNR), repeated until the station's Status confirms them.
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "ctl/client.hpp"
#include "ctl/commands.hpp"
#include "ctl/output.hpp"
#include "ctl/replies.hpp"
#include "dds_bridge/text.hpp"
#include "scan/clock.hpp"
#include "scan/codes.hpp"

namespace stationd::ctl {
namespace {

using bus::code_text;
using bus::printable;
using bus::state_text;

constexpr std::int64_t kRepeat_ns = 300'000'000;

enum class Verdict : std::uint8_t { open, confirmed, refused };

/// One station's order and what has become of it.
struct Order {
  std::string station;
  std::string id;
  std::int64_t sent_ns = 0;  ///< the first time
  Verdict verdict = Verdict::open;
  std::string text;
};

StationState state_of(const bus::Status& status) {
  return static_cast<StationState>(std::min<std::uint32_t>(status.STATE, 3));
}

void settle(Order& order, Verdict verdict, std::string text) {
  order.verdict = verdict;
  order.text = std::move(text);
}

void judge_start(Order& order, const bus::Status& status) {
  if (state_of(status) == StationState::RUNNING) return settle(order, Verdict::confirmed, "RUNNING");
  if (state_of(status) == StationState::FAULT) return settle(order, Verdict::refused, fault_text(status));
}

void judge_stop(Order& order, const bus::Status& status, bool end_of_piece) {
  switch (state_of(status)) {
    case StationState::STOPPED:
      // Only an ordered stop keeps the supervisor from starting it.
      if (status.STOP_CAUSE == static_cast<std::uint32_t>(StopCause::ordered))
        settle(order, Verdict::confirmed, "STOPPED");
      return;
    case StationState::STOPPING:
      if (end_of_piece) settle(order, Verdict::confirmed, "STOPPING: it stops when its piece is finished");
      return;
    case StationState::FAULT:
      return settle(order, Verdict::confirmed, "in FAULT, so it does not run: " + code_text(status.FAULT));
    case StationState::RUNNING: return;
  }
}

class Orders {
 public:
  Orders(const Arguments& arguments, Client& client, bool is_start)
      : arguments_(arguments), client_(client), is_start_(is_start) {}

  void add(const std::string& station) {
    Order order{
        .station = station, .id = client_.new_id(), .sent_ns = 0, .verdict = Verdict::open, .text = {}};
    orders_.push_back(std::move(order));
  }

  /// True: all are settled.
  bool carry_out(std::int64_t until_ns) {
    refuse_what_cannot_be();
    for (;;) {
      send();
      const std::int64_t pause_ns = std::min(until_ns, monotonic_ns() + kRepeat_ns);
      if (client_.wait(pause_ns, [this] { return judge(); })) return true;
      if (monotonic_ns() >= until_ns) return false;
    }
  }

  std::vector<Order>& all() { return orders_; }

 private:
  /// Parameters are taken at Start alone: a station that runs already would confirm what it did not do.
  void refuse_what_cannot_be() {
    const Stations stations = client_.stations();
    for (Order& order : orders_) {
      const auto it = stations.find(order.station);
      const bool running = it != stations.end() && state_of(it->second.status) == StationState::RUNNING;
      if (is_start_ && running && !arguments_.text.empty())
        settle(order, Verdict::refused,
               "it is RUNNING already; parameters are taken at Start: stop it first");
    }
  }

  void send() {
    for (Order& order : orders_) {
      if (order.verdict != Verdict::open) continue;
      if (order.sent_ns == 0) order.sent_ns = monotonic_ns();
      if (is_start_) {
        client_.bus().write_start(
            {order.station, client_.addressed(arguments_.text, order.id), bus::Order::START});
      } else {
        const std::string mode = arguments_.end_of_piece ? "mode=end_of_piece" : "mode=immediate";
        client_.bus().write_stop({order.station, client_.addressed(mode, order.id), bus::Order::STOP});
      }
    }
  }

  /// Under the client's lock. What a Status said before the order was sent confirms nothing.
  bool judge() {
    bool all = true;
    for (Order& order : orders_) {
      const auto it = client_.seen().find(order.station);
      if (order.verdict == Verdict::open && it != client_.seen().end() &&
          it->second.receipt_ns > order.sent_ns) {
        if (is_start_)
          judge_start(order, it->second.status);
        else
          judge_stop(order, it->second.status, arguments_.end_of_piece);
      }
      if (order.verdict == Verdict::open) judge_reply(order);
      all = all && order.verdict != Verdict::open;
    }
    return all;
  }

  /// An RNR needs no answer, but a station may say why it refuses.
  void judge_reply(Order& order) {
    const bus::MsgRes* reply = client_.reply_to(order.id);
    if (reply == nullptr || !reply->ERROR) return;
    if (reply->STATUS != code::start_in_wrong_state)
      return settle(order, Verdict::refused, refusal_text(*reply));
    // In which state, and by which fault, is in the Status: it may have come before the order was sent.
    const auto it = client_.seen().find(order.station);
    if (it == client_.seen().end()) return;
    const StationState state = state_of(it->second.status);
    if (state == StationState::FAULT) settle(order, Verdict::refused, fault_text(it->second.status));
    if (state == StationState::STOPPING)
      settle(order, Verdict::refused, "it is STOPPING: Start it when its piece is finished");
  }

  const Arguments& arguments_;
  Client& client_;
  const bool is_start_;
  std::vector<Order> orders_;
};

std::string json_of(const Order& order, const Stations& stations) {
  const auto it = stations.find(order.station);
  JsonObject out;
  out.text("station", order.station).flag("ok", order.verdict == Verdict::confirmed);
  out.text("state", it == stations.end() ? "" : state_text(it->second.status.STATE))
      .text("message", order.text);
  return out.str();
}

int report(const Arguments& arguments, std::vector<Order>& orders, const Stations& stations, bool is_start) {
  int status = kDone;
  std::vector<std::string> values;
  for (Order& order : orders) {
    if (order.verdict == Verdict::open) {
      Arguments about = arguments;
      about.station = order.station;
      order.text =
          no_answer_text(about, is_start ? "did not confirm Start" : "did not confirm Stop", stations);
      if (is_start && !arguments.text.empty())
        order.text += "; its parameters: stationctl msg " + printable(order.station) + " params";
      std::fprintf(stderr, "stationctl: %s\n", order.text.c_str());
      status = kNoAnswer;
    } else if (order.verdict == Verdict::refused) {
      std::fprintf(stderr, "stationctl: %s refused %s: %s\n", printable(order.station).c_str(),
                   is_start ? "Start" : "Stop", order.text.c_str());
      if (status == kDone) status = kRefused;
    } else if (!arguments.json) {
      print_line(printable(order.station) + " " + order.text);
    }
    values.push_back(json_of(order, stations));
  }
  if (arguments.json) {
    JsonObject out;
    out.text("command", is_start ? "start" : "stop").flag("ok", status == kDone);
    print_line(out.raw("stations", json_array(values)).str());
  }
  return status;
}

int order(const Arguments& arguments, bool is_start) {
  Client client(arguments);
  const std::int64_t until_ns = monotonic_ns() + arguments.timeout_ns;
  Orders orders(arguments, client, is_start);
  if (arguments.station == "all") {
    for (const auto& [name, seen] : client.settle(until_ns)) orders.add(name);
    if (orders.all().empty()) return fail(arguments, kNoStation, no_station_text(arguments, {}));
  } else {
    if (!client.wait(until_ns, [&] { return client.seen().contains(arguments.station); }))
      return fail(arguments, kNoStation, no_station_text(arguments, client.stations()));
    orders.add(arguments.station);
  }
  orders.carry_out(monotonic_ns() + arguments.timeout_ns);
  return report(arguments, orders.all(), client.stations(), is_start);
}

}  // namespace

int start(const Arguments& arguments) { return order(arguments, true); }

int stop(const Arguments& arguments) { return order(arguments, false); }

}  // namespace stationd::ctl

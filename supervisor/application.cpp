#include "supervisor/application.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <iterator>
#include <random>
#include <utility>

#include "dds_bridge/body.hpp"
#include "scan/clock.hpp"
#include "supervisor/answers.hpp"
#include "supervisor/live.hpp"

namespace stationd::supervisor {
namespace {

constexpr std::int64_t kTick_ns = 50'000'000;
constexpr std::int64_t kSaveEvery_ns = 200'000'000;
/// How long a supervisor asks whether another of its name commands, and how often. Peers match within 0.3 s.
constexpr std::int64_t kProbe_ns = 1'000'000'000;
constexpr std::int64_t kProbeEvery_ns = 200'000'000;
constexpr std::string_view kProbePrefix = "probe-";

std::string new_instance() {
  std::random_device random;
  static constexpr std::string_view digits = "0123456789abcdef";
  std::string out;
  for (int i = 0; i < 12; ++i) out += digits[random() % digits.size()];
  return out + "-" + std::to_string(::getpid());
}

ModelOptions model_options(const config::SupervisorConfiguration& configuration, const Arguments& arguments) {
  ModelOptions options;
  options.name = arguments.name.empty() ? configuration.name : arguments.name;
  options.stations = configuration.stations;
  options.count_at = arguments.count_at;
  options.start_repeat_ns = configuration.start_repeat_ns;
  options.stale_after_ns = configuration.stale_after_ns;
  return options;
}

bus::Options bus_options(const config::SupervisorConfiguration& configuration, const Arguments& arguments) {
  bus::Options options = configuration.bus;
  if (!arguments.name.empty()) options.name = arguments.name;
  return options;
}

SavedState loaded(StateStore& store, std::vector<std::string>& notes) {
  std::string problem;
  SavedState state = store.load(problem);
  if (!problem.empty()) notes.push_back(problem);
  return state;
}

}  // namespace

void Inbox::push(Received received) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= kCapacity) {
      lost_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    waiting_.push_back(std::move(received));
  }
  filled_.notify_one();
}

std::deque<Received> Inbox::take(std::int64_t timeout_ns) {
  std::unique_lock lock(mutex_);
  filled_.wait_for(lock, std::chrono::nanoseconds(timeout_ns), [this] { return !waiting_.empty(); });
  return std::exchange(waiting_, {});
}

Application::Application(const config::SupervisorConfiguration& configuration, const Arguments& arguments,
                         StateStore& store, Screen& screen)
    : arguments_(arguments), store_(store), screen_(screen),
      model_(model_options(configuration, arguments), loaded(store, own_notes_)), instance_(new_instance()),
      bus_(bus_options(configuration, arguments)) {
  model_.set_role(Role::observing);  // until nobody else of this name has been found to command
  static_cast<void>(model_.take_notes());
  saved_version_ = model_.save_version();
}

Application::~Application() { bus_.stop(); }

bus::Handlers Application::handlers() {
  bus::Handlers handlers;
  const auto put = [this](auto message, const bus::Origin& origin) {
    inbox_.push({std::move(message), origin});
  };
  handlers.on_set = put;
  handlers.on_end = put;
  handlers.on_status = put;
  handlers.on_gse = put;
  handlers.on_start = [put](const bus::MsgReq& m, const bus::Origin& o) { put(Received::Start{m}, o); };
  handlers.on_stop = [put](const bus::MsgReq& m, const bus::Origin& o) { put(Received::Stop{m}, o); };
  const std::string name = model_.options().name;
  // The filter on names would hide orders to the stations, so requests to others are passed over here.
  handlers.on_request = [put, name](const bus::MsgReq& m, const bus::Origin& o) {
    if (m.DEST_STATION == name) put(Received::Request{m}, o);
  };
  handlers.on_reply = [put, name](const bus::MsgRes& m, const bus::Origin& o, const bus::Origin&) {
    if (m.DEST_STATION == name) put(m, o);
  };
  handlers.on_liveliness = [put](const std::string& topic, int alive, int) {
    put(Received::Alive{topic, alive}, bus::Origin{});
  };
  handlers.on_incompatible = [put](const std::string& topic, const std::string& policy) {
    put(Received::Incompatible{topic, policy}, bus::Origin{});
  };
  return handlers;
}

void Application::feed(const Received& received) {
  const std::int64_t at_ns = received.origin.receipt_ns != 0 ? received.origin.receipt_ns : monotonic_ns();
  struct Visitor {
    Application& app;
    const bus::Origin& origin;
    std::int64_t at_ns;
    void operator()(const bus::Set& m) const { app.model_.on_set(m, at_ns); }
    void operator()(const bus::End& m) const { app.model_.on_end(m, at_ns); }
    void operator()(const bus::Status& m) const { app.model_.on_status(m, at_ns); }
    void operator()(const bus::Gse& m) const { app.model_.on_gse(m, at_ns); }
    void operator()(const Received::Start& m) const { app.model_.on_start(m.order, origin.order); }
    void operator()(const Received::Stop& m) const { app.model_.on_stop(m.order, origin.order, at_ns); }
    void operator()(const Received::Request& m) const { app.answer_request(m.request, origin); }
    void operator()(const Received::Alive& m) const { app.model_.on_liveliness(m.topic, m.alive); }
    void operator()(const Received::Incompatible& m) const {
      app.own_notes_.push_back("a peer of topic " + m.topic + " is not compatible: " + m.policy);
    }
    void operator()(const bus::MsgRes& m) const {
      if (app.role_settled_) return;
      if (m.BODY != "id=" + std::string(kProbePrefix) + app.instance_ + " role=commanding") return;
      app.own_notes_.emplace_back("another supervisor of this name commands the cell");
      app.role_settled_ = true;
    }
  };
  std::visit(Visitor{*this, received.origin, at_ns}, received.message);
}

void Application::answer_request(const bus::MsgReq& request, const bus::Origin& origin) {
  const bus::Body body = bus::parse_body(request.BODY, request.BODY.size());
  std::string_view id = body.id;
  if (id.starts_with(kProbePrefix)) {
    id.remove_prefix(kProbePrefix.size());
    if (id == instance_) return;  // our own question
    // Two that start at the same time: the one whose instance sorts first will command.
    if (!role_settled_ && !arguments_.observe && id < instance_) {
      own_notes_.emplace_back(
          "another supervisor of this name starts at the same time and commands the cell");
      role_settled_ = true;
    }
  }
  // Of several with one name, one answers.
  if (model_.role() != Role::commanding && !arguments_.observe) return;
  bus_.write_reply(answer(model_, request, monotonic_ns()), origin);
}

/// One supervisor commands; others observe. Asks for a second whether another of this name commands; if none
/// says
/// so, this one does, for as long as it lives.
void Application::settle_role(std::int64_t now_ns) {
  if (role_settled_) return;
  if (arguments_.observe) {
    own_notes_.emplace_back("this supervisor only observes");
    role_settled_ = true;
    return;
  }
  if (now_ns - began_ns_ >= kProbe_ns) {
    role_settled_ = true;
    model_.set_role(Role::commanding);
    return;
  }
  if (probed_ns_ != 0 && now_ns - probed_ns_ < kProbeEvery_ns) return;
  probed_ns_ = now_ns;
  const std::string& name = model_.options().name;
  bus_.write_request(
      {name, "role from=" + name + " id=" + std::string(kProbePrefix) + instance_, bus::Order::MSG});
}

void Application::carry_out(const Action& action) {
  std::string body = action.body + (action.body.empty() ? "" : " ") + "from=" + model_.options().name;
  body += " id=" + std::to_string(++orders_sent_);
  const bool start = action.kind == Action::Kind::start;
  const bool sent = start ? bus_.write_start({action.station, std::move(body), bus::Order::START})
                          : bus_.write_stop({action.station, std::move(body), bus::Order::STOP});
  if (!sent) own_notes_.push_back(action.station + ": the order could not be written; it is repeated");
}

void Application::save(std::int64_t now_ns, bool at_once) {
  if (model_.save_version() == saved_version_) return;
  if (!at_once && save_tried_ns_ != 0 && now_ns - save_tried_ns_ < kSaveEvery_ns) return;
  save_tried_ns_ = now_ns;
  const std::uint64_t version = model_.save_version();
  std::string problem = store_.save(model_.saved());
  if (problem.empty()) saved_version_ = version;
  if (problem != save_problem_ && !problem.empty())
    own_notes_.push_back("intents and counts could not be saved: " + problem);
  save_problem_ = std::move(problem);
}

void Application::run(const std::atomic<bool>& stop) {
  began_ns_ = monotonic_ns();
  bus_.prepare_writers({"Start", "Stop", "Msg_Req", "Msg_Res"});
  bus_.start(handlers());
  while (!stop.load()) {
    for (const Received& received : inbox_.take(kTick_ns)) feed(received);
    const std::int64_t now_ns = monotonic_ns();
    settle_role(now_ns);
    for (const Action& action : model_.tick(now_ns)) carry_out(action);
    save(now_ns, false);
    if (inbox_.lost() != lost_noted_) {
      lost_noted_ = inbox_.lost();
      own_notes_.push_back(std::to_string(lost_noted_) +
                           " messages lost: they come faster than they are read");
    }
    std::vector<std::string> lines = std::exchange(own_notes_, {});
    std::ranges::move(model_.take_notes(), std::back_inserter(lines));
    if (!lines.empty()) screen_.notes(lines);
    screen_.update(model_, now_ns);
    if (arguments_.pieces && model_.pieces() >= *arguments_.pieces) break;
  }
  bus_.stop();
  ended_ns_ = monotonic_ns();
  save(ended_ns_, true);
  screen_.close();
  if (!own_notes_.empty()) screen_.notes(std::exchange(own_notes_, {}));
}

std::string Application::summary() const { return supervisor::summary(model_, ended_ns_, began_ns_); }

}  // namespace stationd::supervisor

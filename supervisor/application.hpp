// Application: the supervisor as a whole: bus, model, state and view put together, and its main loop.
// Owned by main() (or a test).
// run() on the thread that made it; bus call-backs come in on the bus-in thread and only fill the inbox.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <variant>
#include <vector>

#include "config/config.hpp"
#include "dds_bridge/bus.hpp"
#include "supervisor/arguments.hpp"
#include "supervisor/model.hpp"
#include "supervisor/state.hpp"

namespace stationd::supervisor {

/// What the bus brought, in the order of receipt.
struct Received {
  struct Start {
    bus::MsgReq order;
  };
  struct Stop {
    bus::MsgReq order;
  };
  struct Request {
    bus::MsgReq request;
  };
  struct Alive {
    std::string topic;
    int alive = 0;
  };
  struct Incompatible {
    std::string topic, policy;
  };
  std::variant<bus::Set, bus::End, bus::Status, bus::Gse, Start, Stop, Request, bus::MsgRes, Alive,
               Incompatible>
      message;
  bus::Origin origin;
};

/// Hands messages from the bus-in thread to the main loop. Bounded: what comes when it is full is counted
/// and lost.
class Inbox {
 public:
  static constexpr std::size_t kCapacity = 100'000;
  /// Bus-in thread.
  void push(Received received);
  /// Main thread: all there is; waits up to `timeout_ns` for the first.
  std::deque<Received> take(std::int64_t timeout_ns);
  std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  std::mutex mutex_;
  std::condition_variable filled_;
  std::deque<Received> waiting_;
  std::atomic<std::uint64_t> lost_{0};
};

/// Where lines for people go: a log, or the terminal's view.
class Screen {
 public:
  Screen() = default;
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;
  virtual ~Screen() = default;
  virtual void notes(const std::vector<std::string>& lines) = 0;
  /// Called every 50 ms or so; decides itself how often it draws.
  virtual void update(const Model& model, std::int64_t now_ns) = 0;
  /// The view is over; what is printed from here on stays.
  virtual void close() = 0;
};

class Application {
 public:
  /// Makes the bus. Throws bus::BusError.
  Application(const config::SupervisorConfiguration& configuration, const Arguments& arguments,
              StateStore& store, Screen& screen);
  ~Application();

  /// Until `stop` is set or the pieces asked for have been counted.
  void run(const std::atomic<bool>& stop);
  /// What was done, for the end.
  std::string summary() const;
  const Model& model() const noexcept { return model_; }

 private:
  bus::Handlers handlers();
  void feed(const Received& received);
  void answer_request(const bus::MsgReq& request, const bus::Origin& origin);
  void settle_role(std::int64_t now_ns);
  void carry_out(const Action& action);
  void save(std::int64_t now_ns, bool at_once);

  const Arguments arguments_;
  StateStore& store_;
  Screen& screen_;
  std::vector<std::string>
      own_notes_;  ///< before the model: loading what was saved may have something to say
  Model model_;
  Inbox inbox_;
  const std::string instance_;  ///< tells this process from others of the same name
  std::int64_t began_ns_ = 0;
  std::int64_t ended_ns_ = 0;
  bool role_settled_ = false;
  std::int64_t probed_ns_ = 0;
  std::uint64_t orders_sent_ = 0;
  std::uint64_t saved_version_ = 0;
  std::int64_t save_tried_ns_ = 0;
  std::string save_problem_;
  std::uint64_t lost_noted_ = 0;
  bus::Bus bus_;  ///< last: its thread ends before the rest goes
};

}  // namespace stationd::supervisor

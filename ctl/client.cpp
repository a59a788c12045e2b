#include "ctl/client.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#include "scan/clock.hpp"

namespace stationd::ctl {
namespace {

/// No further station for so long: they are all there. Peers on a machine match within 0.3 s, and Status is
/// repeated every 0.1 s.
constexpr std::int64_t kQuiet_ns = 700'000'000;

bus::Options bus_options(const Arguments& arguments, const std::string& name) {
  bus::Options options;
  options.domain = arguments.domain;
  options.cell = arguments.cell;
  options.interfaces = arguments.interfaces;
  options.name = name;
  return options;
}

}  // namespace

Client::Client(const Arguments& arguments, bool with_events, bool with_stats)
    : name_("stationctl-" + std::to_string(::getpid())), newest_station_ns_(monotonic_ns()),
      bus_(bus_options(arguments, name_)) {
  bus_.prepare_writers({"Start", "Stop", "Msg_Req"});
  bus_.start(handlers(with_events, with_stats));
}

Client::~Client() { bus_.stop(); }

bus::Handlers Client::handlers(bool with_events, bool with_stats) {
  bus::Handlers handlers;
  handlers.on_status = [this](const bus::Status& status, const bus::Origin& origin) {
    {
      const std::lock_guard lock(mutex_);
      Seen& seen = stations_[status.STATION];
      if (seen.receipt_ns == 0) newest_station_ns_ = monotonic_ns();
      seen = {status, monotonic_ns()};
      writers_.emplace(origin.writer_high, origin.writer_low);
    }
    changed_.notify_all();
  };
  handlers.on_reply = [this](const bus::MsgRes& reply, const bus::Origin&, const bus::Origin&) {
    {
      const std::lock_guard lock(mutex_);
      replies_.push_back(reply);
    }
    changed_.notify_all();
  };
  handlers.on_liveliness = [this](const std::string& topic, int alive, int) {
    const std::lock_guard lock(mutex_);
    if (topic == "Status") writers_alive_ = alive;
  };
  if (with_events) {
    handlers.on_gse = [this](const bus::Gse& gse, const bus::Origin&) {
      {
        const std::lock_guard lock(mutex_);
        events_.push_back(gse);
      }
      changed_.notify_all();
    };
  }
  if (with_stats) {
    handlers.on_stats = [this](const bus::ScanStats& stats, const bus::Origin&) {
      {
        const std::lock_guard lock(mutex_);
        stats_[stats.STATION] = stats;
      }
      changed_.notify_all();
    };
  }
  handlers.names = {name_};  // replies to us alone
  return handlers;
}

bool Client::wait(std::int64_t until_ns, const std::function<bool()>& holds) {
  std::unique_lock lock(mutex_);
  const std::int64_t left_ns = std::max<std::int64_t>(until_ns - monotonic_ns(), 0);
  return changed_.wait_for(lock, std::chrono::nanoseconds(left_ns), holds);
}

Stations Client::settle(std::int64_t until_ns, const std::function<void()>& meanwhile) {
  for (;;) {
    if (meanwhile) meanwhile();
    std::unique_lock lock(mutex_);
    const std::int64_t now_ns = monotonic_ns();
    const bool all_heard = static_cast<int>(writers_.size()) >= writers_alive_;
    const bool quiet = now_ns - newest_station_ns_ >= kQuiet_ns;
    if (now_ns >= until_ns || (quiet && all_heard && !stations_.empty())) return stations_;
    changed_.wait_for(lock, std::chrono::milliseconds(50));
  }
}

Stations Client::stations() {
  const std::lock_guard lock(mutex_);
  return stations_;
}

const bus::MsgRes* Client::reply_to(const std::string& id) const {
  const auto it = std::ranges::find_if(replies_, [&](const bus::MsgRes& reply) {
    return reply.BODY == "id=" + id || reply.BODY.starts_with("id=" + id + " ");
  });
  return it == replies_.end() ? nullptr : &*it;
}

std::vector<bus::Gse> Client::take_events() {
  const std::lock_guard lock(mutex_);
  return std::exchange(events_, {});
}

std::string Client::new_id() { return std::to_string(++ids_); }

std::string Client::addressed(const std::string& words, const std::string& id) const {
  return words + (words.empty() ? "" : " ") + "from=" + name_ + " id=" + id;
}

}  // namespace stationd::ctl

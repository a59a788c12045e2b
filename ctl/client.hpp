// Client: what stationctl sees of the cell: the newest Status of each station, replies, events.
// Owned by a command.
// The command's thread; call-backs come in on the bus-in thread and only fill it, under its mutex.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ctl/arguments.hpp"
#include "dds_bridge/bus.hpp"

namespace stationd::ctl {

struct Seen {
  bus::Status status;
  std::int64_t receipt_ns = 0;  ///< CLOCK_MONOTONIC
};
using Stations = std::map<std::string, Seen>;

class Client {
 public:
  /// Joins the bus. Throws bus::BusError.
  explicit Client(const Arguments& arguments, bool with_events = false, bool with_stats = false);
  ~Client();

  /// Waits until `holds` is true of what was seen, at most until `until_ns`. The last value of it.
  bool wait(std::int64_t until_ns, const std::function<bool()>& holds);
  /// Waits until no further station turns up, at most until `until_ns`; calls `meanwhile` every 50 ms or so.
  Stations settle(std::int64_t until_ns, const std::function<void()>& meanwhile = {});
  /// All stations seen so far. Inside wait() use seen().
  Stations stations();
  /// Valid under wait() only: the stations, the replies to a request and all events.
  const Stations& seen() const { return stations_; }
  const std::map<std::string, bus::ScanStats>& stats_seen() const { return stats_; }
  const bus::MsgRes* reply_to(const std::string& id) const;
  std::vector<bus::Gse> take_events();

  /// A new id for a request or order.
  std::string new_id();
  /// "WORDS from=US id=ID".
  std::string addressed(const std::string& words, const std::string& id) const;
  bus::Bus& bus() { return bus_; }

 private:
  bus::Handlers handlers(bool with_events, bool with_stats);

  const std::string name_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Stations stations_;
  std::set<std::pair<std::uint64_t, std::uint64_t>> writers_;  ///< of Status, heard from
  int writers_alive_ = 0;
  std::int64_t newest_station_ns_ = 0;
  std::vector<bus::MsgRes> replies_;
  std::vector<bus::Gse> events_;
  std::map<std::string, bus::ScanStats> stats_;  ///< the newest of each station
  std::uint64_t ids_ = 0;
  bus::Bus bus_;  ///< last: its thread ends before the rest goes
};

}  // namespace stationd::ctl

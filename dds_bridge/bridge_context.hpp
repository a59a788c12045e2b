// Context: what the parts of a StationBridge share: its stations, pending requests, log, counters.
// Private to dds_bridge; owned by the bridge, outlives its threads.
// The bus-in, bus-out and event threads; each member says who.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "dds_bridge/body.hpp"
#include "dds_bridge/station_bridge.hpp"
#include "dds_bridge/tag_orders.hpp"
#include "dds_bridge/text.hpp"
#include "dds_bridge/throttle.hpp"

namespace stationd::bus {

/// "ST1306 (unknown tag)"
std::string code_with_name(std::uint32_t code);

/// A station as the bridge sees it.
struct BridgedEntry {
  explicit BridgedEntry(BridgedStation bridged)
      : station(bridged.station), figures(std::move(bridged.figures)),
        histogram(std::move(bridged.histogram)) {}
  Station* const station;
  const std::function<TaskFigures()> figures;
  const std::function<std::vector<BucketCount>(Figure, Window)> histogram;
  std::mutex mutex;              // for the following two; bus-in and bus-out
  std::optional<Status> status;  // the newest, published or not
  TagChanges changes;
};

/// A request that the scan is working on.
struct Pending {
  BridgedEntry* entry = nullptr;
  Origin origin;
  Body body;
  Request request;
};

/// Requests by token. Bus-in adds, bus-out takes. Bounded: the oldest leave when replies were lost on the
/// way.
class PendingTable {
 public:
  /// Sets the request's token.
  void add(Pending pending, Request& request);
  std::optional<Pending> take(std::uint64_t token);

 private:
  static constexpr std::size_t kMost = 4096;
  std::mutex mutex_;
  std::uint64_t last_ = 0;
  std::map<std::uint64_t, Pending> waiting_;
};

struct Counters {
  std::atomic<std::uint64_t> orders_refused{0}, orders_busy{0}, events_lost{0}, replies_lost{0};
};

struct Context {
  Context(Bus& the_bus, BridgeOptions the_options, LogSink sink)
      : bus(the_bus), options(std::move(the_options)), log(std::move(sink)) {}
  Bus& bus;
  const BridgeOptions options;
  Throttle log;
  std::vector<std::unique_ptr<BridgedEntry>> stations;
  PendingTable pending;
  Counters counters;
  std::atomic<bool> listening{true};  ///< for a duplicate; ended by bus-out
  std::atomic<bool> gave_way{false};  ///< to a duplicate; set by bus-in, for good
  std::atomic<bool> closed{false};    ///< stop() was called: events go on, nothing else is taken

  /// Whether nothing may be published, and nothing but Stop be taken.
  bool quiet() const noexcept { return listening.load() || gave_way.load(); }
  BridgedEntry* find(const std::string& station) noexcept;
  /// Any plain thread. Writes a reply; counts a failure.
  void reply(const Body& body, const Origin& origin, std::uint32_t code, std::uint32_t refusal,
             const std::string& text);
};

}  // namespace stationd::bus

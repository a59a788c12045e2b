// Bus: one DDS participant with the cell's topics; typed writing, reading by call-backs, requests and
// replies.
// Owned by the composer (daemon, supervisor, stationctl).
// Create, use and destroy from plain threads only, never from a real-time one; call-backs run on the bus-in
// thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "dds_bridge/messages.hpp"
#include "dds_bridge/options.hpp"

namespace stationd::bus {

/// DDS could not be set up; the text says what and why, for people.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Where a sample came from, as far as DDS tells.
struct Origin {
  std::int64_t receipt_ns = 0;  ///< CLOCK_MONOTONIC at take()
  /// writer's GUID; for correlation and for telling writers apart
  std::uint64_t writer_high = 0, writer_low = 0;
  std::int64_t sequence = 0;  ///< sample's sequence number at that writer
  /// Start and Stop: their place in the order in which both were received, from 1. Stops are handed out first
  /// although a Start was received before them; these numbers tell.
  std::uint64_t order = 0;
};

/// Handlers; unset ones cost no reader. All run on the bus-in thread, one at a time; they must not block for
/// long.
struct Handlers {
  std::function<void(const Set&, const Origin&)> on_set;
  std::function<void(const End&, const Origin&)> on_end;
  std::function<void(const Status&, const Origin&)> on_status;
  std::function<void(const ScanStats&, const Origin&)> on_stats;
  std::function<void(const Gse&, const Origin&)> on_gse;
  std::function<void(const MsgReq&, const Origin&)> on_start;
  std::function<void(const MsgReq&, const Origin&)> on_stop;
  std::function<void(const MsgReq&, const Origin&)> on_request;  ///< Msg_Req
  std::function<void(const MsgRes&, const Origin&, const Origin& related)> on_reply;
  /// Topic name, number of live writers and the change (+1, -1); of Status, Set, End readers. A writer counts
  /// as live until its participant says goodbye or its lease ends (3 s), since our readers must not request a
  /// lease: a foreign writer that offers none would not match. Staleness is judged from the time of receipt,
  /// which is quicker.
  std::function<void(const std::string& topic, int alive, int change)> on_liveliness;
  /// Topic name, policy name: a peer is not compatible.
  std::function<void(const std::string& topic, const std::string& policy)> on_incompatible;
  /// for on_set, on_end, on_status, on_stats: content filter by STATION; empty: all
  std::vector<std::string> stations;
  /// for orders, requests, replies: content filter by DEST_STATION; empty: all
  std::vector<std::string> names;
};

/// Quality of service of one endpoint, read back from it. INT64_MAX: none.
struct EndpointQos {
  std::string topic;
  bool writer = false;
  bool reliable = false;
  bool transient_local = false;
  bool keep_all = false;
  std::int32_t depth = 0;  ///< keep last: samples per key; keep all: the bound
  std::int64_t deadline_ns = 0;
  std::int64_t latency_budget_ns = 0;
  std::int64_t lease_ns = 0;
  std::uint32_t transport_priority = 0;  ///< writers
};

class Bus {
 public:
  /// Creates participant, topics, types. Throws BusError.
  explicit Bus(const Options& options);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Creates the readers that the handlers ask for and starts the bus-in thread. Once. Throws BusError.
  void start(Handlers handlers);
  /// Stops and joins the bus-in thread; no call-back runs after it.
  void stop() noexcept;

  /// Writers, made at first use (or by prepare_...); any plain thread. False: not written (counted, see
  /// failures()).
  bool write(const Set& sample);
  bool write(const End& sample);
  bool write(const Status& sample);
  bool write(const ScanStats& sample);
  bool write(const Gse& sample);
  bool write_start(const MsgReq& sample);
  bool write_stop(const MsgReq& sample);
  /// Returns the sample's identity in `identity` for correlating the reply.
  bool write_request(const MsgReq& sample, Origin* identity = nullptr);
  /// `related`: origin of the request that this answers. Where the reader for the reply has not been
  /// discovered yet, the
  /// reply waits for it, half a second at most; so true means taken, not sent.
  bool write_reply(const MsgRes& sample, const Origin& related);
  /// Creates the writers of those topics now ("Set", "Start", ...), so that discovery has begun before the
  /// first write.
  void prepare_writers(const std::vector<std::string>& topics);
  /// Number of matched readers of our writer of that topic.
  int matched_readers(const std::string& topic) const;
  /// Whether a sample of that origin was written by this very Bus.
  bool own(const Origin& origin) const noexcept;
  /// What every GUID of this Bus begins with, as an Origin: `writer_high` and the upper half of `writer_low`.
  Origin self() const noexcept;
  const Options& options() const noexcept;
  /// All endpoints that exist by now.
  std::vector<EndpointQos> endpoints() const;

  std::uint64_t failures() const noexcept;   ///< writes refused
  std::uint64_t malformed() const noexcept;  ///< samples that could not be read
 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The IDL of the cell's own topics, as dds_bridge/cell.idl ships it.
std::string cell_idl();

/// Which DDS this was built with, e.g. "Fast DDS 2.9.1".
std::string dds_version();

}  // namespace stationd::bus

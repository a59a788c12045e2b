// Model: what the supervisor knows of the cell, and what it orders. No DDS, no clock, no thread: it is fed
// messages and the time as a value, and answers with actions; views read it.
// Owned by the application.
// One thread at a time (the application's main thread).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dds_bridge/messages.hpp"
#include "scan/messages.hpp"
#include "supervisor/events.hpp"
#include "supervisor/state.hpp"

namespace stationd::supervisor {

struct ModelOptions {
  std::string name = "supervisor";
  std::vector<std::string> stations;  ///< in the order in which they are started
  std::string count_at;               ///< whose End counts the cell's pieces; empty: the first started
  std::int64_t start_repeat_ns = 500'000'000;
  std::int64_t stale_after_ns = 1'000'000'000;
  std::size_t events_kept = 1000;
};

/// What the supervisor is among those of its name. One commands; the others observe.
enum class Role : std::uint8_t { observing, commanding };

struct Action {
  enum class Kind : std::uint8_t {
    start,       ///< send Start to the station
    repeat_stop  ///< send the operator's Stop again: a Start of ours crossed it
  };
  Kind kind = Kind::start;
  std::string station;
  std::string body;  ///< key=value pairs of the order
};

/// What is known of one station.
struct StationRecord {
  std::string name;
  bool configured = false;  ///< it is in the start order; others are shown, never ordered
  Intent intent = Intent::run;
  PieceCount pieces;
  std::optional<bus::Status> status;  ///< newest
  std::int64_t seen_ns = 0;           ///< receipt of it, CLOCK_MONOTONIC
  std::uint64_t restarts = 0;         ///< new EPOCHs seen
  std::optional<bus::Set> announced;  ///< newest Set
  std::optional<bus::End> finished;   ///< newest End

  bool has_run = false;       ///< RUNNING was seen by this supervisor
  bool stop_awaited = false;  ///< a Stop was seen that no Status has confirmed yet
  std::int64_t stop_seen_ns = 0;
  std::uint64_t stop_number = 0;              ///< receipt number of the newest Stop
  std::string stop_mode;                      ///< "mode=..." of that Stop, or empty
  bool start_crossed = false;                 ///< a Start of ours was under way when that Stop was seen
  std::optional<std::int64_t> start_sent_ns;  ///< newest Start of ours in this epoch
  std::uint64_t starts_sent = 0;

  bool in_state(StationState state) const noexcept {
    return status && status->STATE == static_cast<std::uint32_t>(state);
  }
};

class Model {
 public:
  explicit Model(ModelOptions options, const SavedState& saved = {});

  void on_status(const bus::Status& status, std::int64_t now_ns);
  void on_set(const bus::Set& set, std::int64_t now_ns);
  void on_end(const bus::End& end, std::int64_t now_ns);
  void on_gse(const bus::Gse& gse, std::int64_t now_ns);
  /// Orders on the bus. Our own (from=OUR NAME) are passed over. `receipt_number`: their place in the order
  /// in which
  /// Starts and Stops were received (bus::Origin::order): a Start received before a Stop that came first is
  /// void.
  void on_start(const bus::MsgReq& order, std::uint64_t receipt_number);
  void on_stop(const bus::MsgReq& order, std::uint64_t receipt_number, std::int64_t now_ns);
  /// The number of writers of that topic that are alive (Status, Set, End).
  void on_liveliness(std::string_view topic, int alive);

  void set_role(Role role);
  Role role() const noexcept { return role_; }

  /// Call every 50 ms or so, also when nothing came. Returns what is to be sent now.
  std::vector<Action> tick(std::int64_t now_ns);

  const ModelOptions& options() const noexcept { return options_; }
  /// Configured ones in their order, then the others as they were seen.
  const std::vector<StationRecord>& stations() const noexcept { return stations_; }
  const StationRecord* station(std::string_view name) const noexcept;
  const EventList& events() const noexcept { return events_; }
  /// No Status came for stale_after_ns (or ever).
  bool away(const StationRecord& station, std::int64_t now_ns) const noexcept;
  /// Pieces that have left the cell.
  std::uint64_t pieces() const noexcept;
  const std::string& count_at() const noexcept { return options_.count_at; }

  SavedState saved() const;
  /// Counts up with everything that saved() tells.
  std::uint64_t save_version() const noexcept { return save_version_; }
  /// Lines for the log: what changed since the last call. At most 1000; more are dropped.
  std::vector<std::string> take_notes();

 private:
  StationRecord* find(std::string_view name) noexcept;
  StationRecord* find_or_add(const std::string& name);
  void note(std::string text);
  void set_intent(StationRecord& station, Intent intent, std::string_view why);
  void follow_intent(StationRecord& station, const bus::Status* before, const bus::Status& status,
                     std::int64_t now_ns);
  void note_changes(const StationRecord& station, const bus::Status* before, const bus::Status& status);
  void note_away(std::int64_t now_ns);
  bool waits_for_its_turn(std::size_t index, std::int64_t now_ns) const noexcept;
  bool wants_start(std::size_t index, std::int64_t now_ns) const noexcept;
  bool wants_stop_again(const StationRecord& station, std::int64_t now_ns) const noexcept;

  ModelOptions options_;
  Role role_ = Role::commanding;
  std::vector<StationRecord> stations_;
  std::vector<bool> noted_away_;
  EventList events_;
  int writers_alive_ = 0;
  std::uint64_t save_version_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace stationd::supervisor

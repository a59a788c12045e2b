// Records that cross between a station's scan and the other threads: orders, replies, events, status.
// Owned by the ring or snapshot that carries them; all trivially copyable.
// Any thread.
#pragma once

#include <array>
#include <cstdint>

#include "scan/image.hpp"
#include "scan/value.hpp"

namespace stationd {

/// A station's state, with the numbers that travel in the Status topic.
enum class StationState : std::uint8_t { STOPPED = 0, RUNNING = 1, STOPPING = 2, FAULT = 3 };

/// Why a station stands in STOPPED.
enum class StopCause : std::uint8_t {
  never_started = 0,  ///< since the daemon started
  ordered = 1,        ///< somebody sent Stop
  after_fault = 2     ///< a fault was reset
};

std::string_view name_of(StationState state) noexcept;

/// Whether the program drives the outputs in that state; else they are safe.
constexpr bool driven(StationState state) noexcept {
  return state == StationState::RUNNING || state == StationState::STOPPING;
}

enum class Severity : std::uint8_t { info = 0, warning = 1, fault = 2 };
std::string_view name_of(Severity severity) noexcept;

/// An aperiodic station event (ASE), as the scan raises it.
struct Event {
  std::uint32_t seq = 0;   ///< counts up by one per station and epoch, also over events that a full ring lost
  std::uint32_t code = 0;  ///< see codes.hpp
  Severity severity = Severity::info;
  bool active = false;  ///< faults and warnings: rising (true) or falling edge
  bool edge = true;     ///< false: announced as still active after a restart
  std::uint64_t scan = 0;
  std::int64_t utc_ns = 0;
  std::int64_t detail = 0;  ///< meaning by code; 0: none
};

/// What an order asks of the station, between two scans.
enum class Verb : std::uint8_t {
  start,
  reset,
  get,
  force,        ///< holds an input or output at a value
  unforce,      ///< lets it go
  unforce_all,  ///< lets all of them go
  set,          ///< writes a tag that the configuration declares writable
  tags          ///< copies the image as it is into Station::image_copy()
};

/// Configuration carried by an order: parameter tags set before it takes effect, all or none.
struct Assignment {
  TagIndex tag = 0;
  Slot value = 0;
};

/// An order checked by the bus-in thread and serviced by the scan. Stop is not among them: it has a latch.
struct Request {
  static constexpr std::size_t kMaxAssignments = 16;
  std::uint64_t token = 0;  ///< returned in the reply; 0: nobody waits for one
  std::uint64_t order = 0;  ///< receipt number, shared with Stop: a Start older than the last Stop is void
  Verb verb = Verb::start;
  std::uint8_t assignment_count = 0;
  TagIndex tag = 0;  ///< get, force, unforce, set; tags: the first that is asked for
  Slot value = 0;    ///< force, set; tags: how many are asked for, 0: all that follow
  std::array<Assignment, kMaxAssignments> assignments{};
};

enum class Outcome : std::uint8_t { done, refused };

struct Reply {
  std::uint64_t token = 0;
  Outcome outcome = Outcome::done;
  std::uint32_t code = 0;  ///< why refused; see codes.hpp
  Slot value = 0;          ///< get: first slot; set: the value before; unforce, unforce_all: how many
  bool changed = false;    ///< force, unforce, unforce_all, set: it was not so before
  Quality quality = Quality::BAD;
  StationState state = StationState::STOPPED;
};

/// What a station says of itself at the end of each scan.
struct StatusRecord {
  StationState state = StationState::STOPPED;
  StopCause cause = StopCause::never_started;
  bool ready = false;  ///< RUNNING and willing to take a pallet
  std::uint32_t epoch = 0;
  std::uint32_t fault = 0;    ///< active fault's code; 0: none
  std::uint32_t warning = 0;  ///< an active warning's code; 0: none
  std::uint32_t step = 0;     ///< of the program's sequence
  std::uint32_t piece = 0;    ///< code of the piece in work; 0: none
  std::uint32_t forced = 0;   ///< inputs and outputs that an operator forces
  std::uint64_t scan = 0;
  std::uint64_t deadline_misses = 0;  ///< of the station's task
  std::int64_t time_ns = 0;
  std::int64_t utc_ns = 0;
};

/// How a Stop is to be carried out.
enum class StopMode : std::uint8_t { none = 0, end_of_piece = 1, immediate = 2 };

}  // namespace stationd

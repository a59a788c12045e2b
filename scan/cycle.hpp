// Cycle: what a program may know and ask for within one scan.
// Owned by the station, which makes one for each call of the program.
// The scan thread only; nothing here allocates or blocks.
#pragma once

#include <cstdint>

#include "scan/messages.hpp"
#include "scan/nonblocking.hpp"

namespace stationd {

class Station;

/// How the retained tags came to their values.
enum class Restart : std::uint8_t {
  cold,  ///< initial values: there was no usable record
  warm   ///< as the last save before the restart left them
};

class Cycle {
 public:
  Cycle(Station& station, std::int64_t now_ns) noexcept : station_(station), now_ns_(now_ns) {}

  /// Logical time of this scan, CLOCK_MONOTONIC; the same for all that happens in it.
  std::int64_t now_ns() const noexcept { return now_ns_; }
  std::uint64_t scan() const noexcept STATIOND_NONBLOCKING;
  std::uint32_t epoch() const noexcept STATIOND_NONBLOCKING;
  Restart restart() const noexcept STATIOND_NONBLOCKING;

  StationState state() const noexcept STATIOND_NONBLOCKING;
  /// True in the first execute() after Start: derive the step from the sensors.
  bool started() const noexcept STATIOND_NONBLOCKING;
  /// True while a Stop with mode=end_of_piece waits for finished().
  bool finishing() const noexcept STATIOND_NONBLOCKING;
  /// The piece is done and Stop may take effect: the station is STOPPED after this scan. No effect unless
  /// finishing().
  void finished() noexcept STATIOND_NONBLOCKING;

  /// Latches a fault: FAULT from the end of this scan, outputs safe, event raised. The first in a scan wins.
  void fault(std::uint32_t code, std::int64_t detail = 0) noexcept STATIOND_NONBLOCKING;
  /// A condition that stands or not; call it every scan. Each change raises an event. At most 16 stand at
  /// once.
  void warn(std::uint32_t code, bool active, std::int64_t detail = 0) noexcept STATIOND_NONBLOCKING;
  /// A single event.
  void note(std::uint32_t code, std::int64_t detail = 0) noexcept STATIOND_NONBLOCKING;

  /// For Status: step of the sequence, code of the piece in work (0: none), willing to take a pallet.
  void report(std::uint32_t step, std::uint32_t piece, bool ready) noexcept STATIOND_NONBLOCKING;

  /// Asks that the retained tags, as they are at the end of this scan, be written at once. The ticket tells
  /// when they are.
  std::uint64_t save_retained() noexcept STATIOND_NONBLOCKING;
  /// Whether the record of that ticket is on disk.
  bool saved(std::uint64_t ticket) const noexcept STATIOND_NONBLOCKING;

 private:
  Station& station_;
  std::int64_t now_ns_;
};

}  // namespace stationd

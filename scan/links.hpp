// Links: where a station's tags meet the outside: field devices, the bus, the retained store.
// Owned by the station; the other end (I/O thread, bus thread, housekeeping) holds a reference.
// Scan thread on one side, exactly one other thread on the other; see each member.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "scan/image.hpp"
#include "scan/messages.hpp"
#include "scan/nonblocking.hpp"
#include "scan/ring.hpp"
#include "scan/snapshot.hpp"

namespace stationd {

/// The tags of one link in the order in which their slots stand in its blocks.
struct LinkTags {
  std::vector<TagIndex> tags;
  BlockLayout layout;
};

/// Inputs from one source (a device, or one station's topic). Source thread writes, scan thread reads.
/// The source publishes whole blocks: header.time_ns = local receipt (CLOCK_MONOTONIC), header.count = 1, 2,
/// ..., header.quality = GOOD or, when the source itself knows better (lost, failed), BAD or STALE.
struct InputLink {
  InputLink(std::string source_name, LinkTags link_tags, std::int64_t stale_ns, std::int64_t bad_ns)
      : source(std::move(source_name)), tags(std::move(link_tags)), stale_after_ns(stale_ns),
        bad_after_ns(bad_ns), blocks(tags.layout.size_bytes()) {}
  const std::string source;  ///< device name, or TOPIC/STATION
  const LinkTags tags;
  const std::int64_t stale_after_ns;  ///< age above which the scan judges GOOD as STALE
  const std::int64_t bad_after_ns;    ///< age above which the scan judges it BAD
  std::vector<std::string> members;   ///< bus links: the topic's member for each tag
  Snapshot blocks;
  bool seen = false;  ///< scan thread's own: the source was GOOD at least once
  bool lost = false;  ///< scan thread's own: and is BAD now
};

/// Outputs to one device. Scan thread writes after each execution, the device's thread reads.
struct OutputLink {
  OutputLink(std::string device_name, LinkTags link_tags)
      : device(std::move(device_name)), tags(std::move(link_tags)), blocks(tags.layout.size_bytes()) {}
  const std::string device;
  const LinkTags tags;
  Snapshot blocks;
};

/// A PV group. Scan thread writes on change and at least every `heartbeat_ns`; the bus-out thread reads.
struct PvLink {
  PvLink(std::string topic_name, LinkTags link_tags, std::vector<std::string> member_names,
         std::int64_t heartbeat)
      : topic(std::move(topic_name)), tags(std::move(link_tags)), members(std::move(member_names)),
        heartbeat_ns(heartbeat), blocks(tags.layout.size_bytes()) {}
  const std::string topic;
  const LinkTags tags;
  const std::vector<std::string> members;  ///< for each tag
  const std::int64_t heartbeat_ns;
  /// Publications replaced before they were sent; scan thread counts.
  std::atomic<std::uint64_t> overtaken{0};
  Snapshot blocks;
};

/// The retained tags. Scan thread writes when they change; the retain thread reads, saves, and sets
/// `saved_scan`.
struct RetainLink {
  explicit RetainLink(LinkTags link_tags) : tags(std::move(link_tags)), blocks(tags.layout.size_bytes()) {}
  const LinkTags tags;
  Snapshot blocks;                            ///< header.scan: the scan whose end the values are of
  std::atomic<std::uint64_t> urgent_scan{0};  ///< scan thread: save the block of this scan (or later) at once
  std::atomic<std::uint64_t> saved_scan{0};  ///< retain thread: the newest scan whose block is safely on disk
};

/// All tags as they were between two scans, for whoever asks (Verb::tags). The scan thread writes before it
/// answers, the bus-out thread reads at the answer; a copy made for a later request may take its place.
struct ImageCopy {
  explicit ImageCopy(LinkTags link_tags) : tags(std::move(link_tags)), blocks(tags.layout.size_bytes()) {}
  const LinkTags tags;
  Snapshot blocks;
};

/// Stop: never queued. Bus-in thread sets, the scan takes it first thing in every cycle.
class StopLatch {
 public:
  /// Bus-in thread (any thread, in fact). `order`: receipt number; an immediate Stop is not weakened by a
  /// later gentle one.
  void set(StopMode mode, std::uint64_t order) noexcept {
    std::uint64_t old = word_.load(std::memory_order_relaxed);
    std::uint64_t wanted;
    do {
      const std::uint64_t strongest = std::max<std::uint64_t>(old & 3U, static_cast<std::uint64_t>(mode));
      wanted = (std::max(old >> 2U, order) << 2U) | strongest;
    } while (!word_.compare_exchange_weak(old, wanted, std::memory_order_release, std::memory_order_relaxed));
  }
  /// Scan thread. Whether a Stop waits to be taken.
  bool pending() const noexcept STATIOND_NONBLOCKING { return word_.load(std::memory_order_acquire) != 0; }
  struct Taken {
    StopMode mode;
    std::uint64_t order;
  };
  /// Scan thread; wait-free.
  Taken take() noexcept STATIOND_NONBLOCKING {
    if (word_.load(std::memory_order_relaxed) == 0) return {StopMode::none, 0};
    const std::uint64_t word = word_.exchange(0, std::memory_order_acquire);
    return {static_cast<StopMode>(word & 3U), word >> 2U};
  }

 private:
  std::atomic<std::uint64_t> word_{0};
};

/// Everything of one station that crosses threads.
struct StationPort {
  StationPort(std::size_t requests_capacity, std::size_t events_capacity)
      : requests(requests_capacity), replies(requests_capacity), events(events_capacity) {}

  /// Watchdog thread, or the daemon's set-up before that runs: an event of the runtime's own.
  void announce(std::uint32_t code, Severity severity, std::int64_t detail, std::int64_t utc_ns) noexcept;
  /// Watchdog thread. The scan makes no progress: takes the permit, marks the station as hung, and raises the
  /// event that the scan cannot.
  void hang(std::int64_t idle_ns, std::int64_t utc_ns) noexcept;

  StopLatch stop;
  Ring<Request> requests;       ///< bus-in -> scan. Full: the bus answers "busy" or counts
  Ring<Reply> replies;          ///< scan -> bus-out
  Ring<Event> events;           ///< scan -> event writer. Full: a gap in SEQ and an event of its own
  Latest<StatusRecord> status;  ///< scan -> bus-out
  std::atomic<bool> permit{
      false};  ///< scan grants at Start; watchdog revokes; I/O threads check at every send
  std::atomic<std::uint64_t> progress{0};  ///< scans finished
  /// Watchdog sets; the scan takes it in its next cycle and goes to FAULT; meanwhile bus-out speaks for it.
  std::atomic<bool> hung{false};
  std::atomic<bool> executing{false};       ///< the program has the CPU; the watchdog reads, to name it
  std::atomic<std::uint32_t> event_seq{0};  ///< of the last event; scan and watchdog count
  Ring<Event> runtime_events{8};            ///< watchdog (and set-up before it) -> event writer
};

}  // namespace stationd

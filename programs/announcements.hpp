// Announcements: the pieces that the upstream station has announced by `Set` and that were not yet matched
// to a pallet.
// Owned by a program, which keeps a copy of its Content in retained tags.
// The scan thread; plain values, nothing here allocates.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "scan/nonblocking.hpp"

namespace stationd::programs {

/// One piece, as `Set` and `End` name it: once per (STATION, EPOCH, SEQ).
struct Announcement {
  std::uint32_t epoch = 0;
  std::uint32_t seq = 0;
  std::uint32_t code = 0;
  bool ended = false;  ///< the upstream station has finished it
  bool operator==(const Announcement&) const = default;
};

class Announcements {
 public:
  static constexpr std::size_t kMax = 3;

  struct Content {
    std::array<Announcement, kMax> entries{};  ///< oldest first
    std::uint32_t size = 0;
    std::uint32_t last_epoch = 0;  ///< of the newest Set that was acted on
    std::uint32_t last_seq = 0;
    std::uint32_t last_code =
        0;  ///< tells the pieces of a writer apart that does not number them (Table 4 alone)
    bool operator==(const Content&) const = default;
  };

  enum class Heard : std::uint8_t {
    nothing,  ///< a repetition
    queued,
    gap,      ///< queued, but at least one SEQ before it was never heard
    overflow  ///< queued, and the oldest was dropped for it
  };

  /// A Set as it stands at the input; acted on once. `visible`: pallets that stand unread in the station's
  /// own zones. A new EPOCH with the code of the newest announcement, whose pallet is neither here nor let
  /// go, is that one again: the upstream station lost its record. All others stay: their pallets were let
  /// go, whatever was heard.
  Heard hear_set(const Announcement& set, std::uint32_t visible) noexcept STATIOND_NONBLOCKING;
  /// An End as it stands at the input. A station finishes in order: what it announced earlier in that
  /// EPOCH has ended too. With `error` the piece will not come and its announcement goes.
  void hear_end(const Announcement& end, bool error) noexcept STATIOND_NONBLOCKING;

  /// The oldest; null when there is none.
  const Announcement* front() const noexcept { return content_.size == 0 ? nullptr : &content_.entries[0]; }
  void pop_front() noexcept { remove(0); }
  /// Drops what stands before the oldest announcement of that code, and returns that; null (and drops
  /// nothing) if there is none.
  const Announcement* skip_to(std::uint32_t code) noexcept STATIOND_NONBLOCKING;

  std::uint32_t size() const noexcept { return content_.size; }
  std::uint32_t ended_count() const noexcept STATIOND_NONBLOCKING;
  const Content& content() const noexcept { return content_; }
  /// After a restart. What cannot be (a size above kMax) is taken as empty.
  void restore(const Content& content) noexcept STATIOND_NONBLOCKING;

 private:
  void remove(std::uint32_t index) noexcept STATIOND_NONBLOCKING;
  void drop_void(std::uint32_t visible, std::uint32_t code) noexcept STATIOND_NONBLOCKING;

  Content content_;
};

}  // namespace stationd::programs

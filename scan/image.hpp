// Process image: the tags of one station with their values and qualities, and the blocks in which they
// travel.
// Owned by the station; set up by one thread, then used by its scan thread alone.
// Set-up may allocate and throw; after seal() nothing here does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "scan/nonblocking.hpp"
#include "scan/value.hpp"

namespace stationd {

/// What is known of a tag before it has a place. `initial` and `safe` are given in slots' encoding.
struct TagSpec {
  std::string name;  ///< unique within the station: letters, digits, `_` and `.`
  TagType type = TagType::BOOL;
  Area area = Area::internal;
  std::string unit;
  std::string description;
  std::uint16_t length = 0;  ///< STRING only: most bytes, 1..255
  Slot initial = 0;
  Slot safe = 0;           ///< outputs: value outside RUNNING
  bool hold = false;       ///< outputs: outside RUNNING keep the last value instead
  bool parameter = false;  ///< internal tag whose initial value comes from the configuration
  bool writable = false;   ///< internal and retained tags: an operator may set it while the station runs
  Slot min = 0;            ///< what may be set: least and greatest value; both 0: the type's own range
  Slot max = 0;
};

using TagIndex = std::uint32_t;

/// One station's tags. A tag's slots are consecutive; tags keep the order in which they were added.
class Image {
 public:
  Image() = default;
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;

  /// Set-up, before seal(). Throws SetupError for a name that is empty, malformed or taken, for a STRING
  /// without a length of 1..255, and after seal().
  TagIndex add(TagSpec spec);
  /// Set-up. Gives every tag its place and initial value; pointers from value() and quality() stay valid for
  /// good.
  void seal();

  std::optional<TagIndex> find(std::string_view name) const;
  const TagSpec& spec(TagIndex tag) const { return specs_[tag]; }
  /// Set-up, before seal(): change the specification (initial, safe, hold) from the configuration.
  TagSpec& spec(TagIndex tag) { return specs_[tag]; }
  std::size_t size() const noexcept { return specs_.size(); }
  std::uint32_t slot_count(TagIndex tag) const noexcept STATIOND_NONBLOCKING {
    return sealed() ? first_slot_[tag + 1] - first_slot_[tag] : slots_of(specs_[tag]);
  }
  bool sealed() const noexcept { return !first_slot_.empty(); }

  Slot* value(TagIndex tag) noexcept { return &slots_[first_slot_[tag]]; }
  const Slot* value(TagIndex tag) const noexcept { return &slots_[first_slot_[tag]]; }
  Quality* quality(TagIndex tag) noexcept { return &qualities_[tag]; }
  const Quality* quality(TagIndex tag) const noexcept { return &qualities_[tag]; }

 private:
  static std::uint32_t slots_of(const TagSpec& spec) noexcept STATIOND_NONBLOCKING;

  std::vector<TagSpec> specs_;
  std::unordered_map<std::string, TagIndex> by_name_;
  std::vector<std::uint32_t> first_slot_;  // of each tag, and the end of the last
  std::vector<Slot> slots_;
  std::vector<Quality> qualities_;
};

/// Opens every block that crosses threads.
struct BlockHeader {
  std::int64_t time_ns =
      0;  ///< inputs: CLOCK_MONOTONIC of local receipt; outputs and PVs: the scan's logical time
  std::int64_t utc_ns = 0;         ///< PVs: the scan's time as UTC
  std::uint64_t scan = 0;          ///< outputs, PVs: number of the scan that wrote it
  std::uint64_t count = 0;         ///< publications so far; 0: nothing was ever published
  Quality quality = Quality::BAD;  ///< of the source as a whole
};

/// Shape of a block: header, then `slots` slots, then `tags` qualities.
struct BlockLayout {
  std::uint32_t slots = 0;
  std::uint32_t tags = 0;
  std::size_t size_bytes() const noexcept { return sizeof(BlockHeader) + slots * sizeof(Slot) + tags; }
};

/// A view of a block's bytes (as Snapshot hands them out).
struct BlockView {
  std::byte* bytes;
  BlockLayout layout;
  BlockHeader& header() const noexcept { return *reinterpret_cast<BlockHeader*>(bytes); }
  std::span<Slot> slots() const noexcept {
    return {reinterpret_cast<Slot*>(bytes + sizeof(BlockHeader)), layout.slots};
  }
  std::span<Quality> qualities() const noexcept {
    return {reinterpret_cast<Quality*>(bytes + sizeof(BlockHeader) + layout.slots * sizeof(Slot)),
            layout.tags};
  }
};
struct ConstBlockView {
  const std::byte* bytes;
  BlockLayout layout;
  const BlockHeader& header() const noexcept { return *reinterpret_cast<const BlockHeader*>(bytes); }
  std::span<const Slot> slots() const noexcept {
    return {reinterpret_cast<const Slot*>(bytes + sizeof(BlockHeader)), layout.slots};
  }
  std::span<const Quality> qualities() const noexcept {
    return {reinterpret_cast<const Quality*>(bytes + sizeof(BlockHeader) + layout.slots * sizeof(Slot)),
            layout.tags};
  }
};

}  // namespace stationd

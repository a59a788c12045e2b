// Forces: the inputs and outputs that an operator holds at a value, and what they would be without it.
// Owned by the station.
// The scan thread only; nothing here allocates or blocks. Gone with the process: nothing of it is kept.
#pragma once

#include <array>
#include <cstddef>

#include "scan/image.hpp"
#include "scan/nonblocking.hpp"

namespace stationd {

/// Whether an operator may force the tag: an input or output of one slot. What the program owns (internal,
/// retained, parameters) is set instead, where the configuration lets it.
bool forceable(const TagSpec& spec) noexcept STATIOND_NONBLOCKING;

/// Orders of an operator take effect in the next scan, all in the same place of it. In the image a forced tag
/// has its forced value from apply_...() to lift_...(), so that the source of an input and the program of an
/// output go on with their own.
class Forces {
 public:
  static constexpr std::size_t kMost = 64;  ///< at once in a station

  enum class Taken : std::uint8_t { changed, unchanged, full };

  // -- Between two scans ------------------------------------------------------------------------------------
  /// `tag` is forceable; one that is forced already takes the new value.
  Taken force(TagIndex tag, Slot value, bool output) noexcept STATIOND_NONBLOCKING;
  /// False: it was not forced.
  bool release(TagIndex tag) noexcept STATIOND_NONBLOCKING;
  /// How many stand, without those released.
  std::size_t standing() const noexcept STATIOND_NONBLOCKING { return standing_; }
  /// Lets one of them go; the tag. Only while standing() is not 0.
  TagIndex release_any() noexcept STATIOND_NONBLOCKING;

  // -- Within a scan ----------------------------------------------------------------------------------------
  /// Around the latch of the inputs.
  void lift_inputs(Image& image) noexcept STATIOND_NONBLOCKING;
  void apply_inputs(Image& image) noexcept STATIOND_NONBLOCKING;
  /// Around the program. `driven`: whether the station drives its outputs; else no output takes a forced
  /// value, and one with hold keeps what was committed last, forced or not.
  void lift_outputs(Image& image, bool driven) noexcept STATIOND_NONBLOCKING;
  void apply_outputs(Image& image, bool driven) noexcept STATIOND_NONBLOCKING;

 private:
  struct Force {
    TagIndex tag = 0;
    Slot value = 0;      // ordered
    Slot committed = 0;  // in the image, while applied
    Slot own = 0;        // of the source or the program, while applied
    Quality own_quality = Quality::BAD;
    bool output = false;
    bool applied = false;   // the last scan had it
    bool released = false;  // leaves in the next scan
  };

  Force* find(TagIndex tag) noexcept STATIOND_NONBLOCKING;
  void apply(Image& image, Force& force) noexcept STATIOND_NONBLOCKING;
  void drop(std::size_t at) noexcept STATIOND_NONBLOCKING;

  // As many again may wait to be let go: those were applied, so no more than could stand in one scan.
  std::array<Force, 2 * kMost> forces_{};
  std::size_t count_ = 0;
  std::size_t standing_ = 0;
};

}  // namespace stationd

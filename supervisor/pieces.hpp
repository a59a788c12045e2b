// Pieces: counts what one station finished, by its End messages, once per (EPOCH, SEQ).
// Owned by the model, one per station; its contents are saved (state.hpp).
// The model's thread.
#pragma once

#include <cstdint>
#include <vector>

#include "dds_bridge/messages.hpp"

namespace stationd::supervisor {

/// How far the counting of one epoch has come.
struct EpochCount {
  std::uint32_t epoch = 0;
  std::uint32_t last_seq = 0;
  bool operator==(const EpochCount&) const = default;
};

struct PieceCount {
  static constexpr std::size_t kEpochs = 4;  ///< kept; an End of an older one cannot come any more

  std::uint64_t counted = 0;       ///< Ends seen
  std::uint64_t faulty = 0;        ///< of those, with ERROR
  std::uint64_t missed = 0;        ///< skipped by SEQ: finished while nobody listened
  std::vector<EpochCount> epochs;  ///< in the order in which they came
  /// CODE, ERROR, STATUS of the last End without SEQ (a Table 4 writer): only a change tells pieces apart.
  std::uint32_t plain_code = 0, plain_status = 0;
  bool plain_error = false;

  bool operator==(const PieceCount&) const = default;

  /// All pieces that the station has finished, as far as can be known.
  std::uint64_t finished() const noexcept { return counted + missed; }

  /// The station stands at the beginning of this epoch: nothing was finished in it yet.
  void begin(std::uint32_t epoch);
  /// True if this End is a new piece. An End seen first in an unknown epoch of a station that was never seen
  /// before says nothing of the pieces before it; otherwise the SEQs that it skips count as missed.
  bool add(const bus::End& end);

 private:
  bool add_plain(const bus::End& end);
  EpochCount* find(std::uint32_t epoch);
  EpochCount& append(std::uint32_t epoch, std::uint32_t last_seq);
};

}  // namespace stationd::supervisor

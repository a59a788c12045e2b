// LivePlant: a plant that follows real time (given as values), and its files: the ledger, the saved state.
// Owned by plantsim, or by a SharedPlant.
// One thread at a time.
#pragma once

#include <cstdint>
#include <string>

#include "io/plant/plant.hpp"

namespace stationd::plant {

/// Replaces the file by `text` in one go (temporary file beside it, then rename), so that a reader, or a kill
/// in the middle, never meets half of it. Throws std::system_error naming the file.
void write_atomically(const std::string& path, const std::string& text);

struct LiveOptions {
  double speed = 1.0;       ///< plant seconds per second
  std::string ledger_file;  ///< empty: none
  std::string state_file;   ///< empty: none; loaded at set-up when it is there
};

class LivePlant {
 public:
  /// Throws std::invalid_argument for the configuration, std::runtime_error for a state file that cannot be
  /// used.
  LivePlant(PlantConfig config, LiveOptions options);

  Plant& plant() noexcept { return plant_; }
  const Plant& plant() const noexcept { return plant_; }

  /// Steps the plant up to `now_ns` (CLOCK_MONOTONIC; the first call sets the origin). After a gap of more
  /// than a second the plant goes on one second later and the rest is lost: it stood still as its process
  /// did.
  void advance(std::int64_t now_ns);

  /// A file's new content, when one is due: the ledger each 250 ms, the state each 200 ms, less often when
  /// they are long. Formatting is done here, writing (which may block) by the caller.
  struct Due {
    std::string ledger, state;
    bool any() const noexcept { return !ledger.empty() || !state.empty(); }
  };
  Due due(std::int64_t now_ns);
  /// Throws std::system_error.
  void write(const Due& due) const;
  /// Both files for the last time. Throws std::system_error.
  void finish();

 private:
  Plant plant_;
  LiveOptions options_;
  bool started_ = false;
  std::int64_t real_origin_ns_ = 0;
  std::int64_t plant_origin_ns_ = 0;
  std::int64_t last_now_ns_ = 0;
  std::int64_t ledger_due_ns_ = 0;
  std::int64_t state_due_ns_ = 0;
};

}  // namespace stationd::plant

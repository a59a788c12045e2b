// State: what the supervisor remembers over its own restart: the intent for each station, the piece counts.
// Owned by the application; the store is a seam: file, none, or in memory for tests.
// The model's thread.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "scan/error.hpp"
#include "supervisor/pieces.hpp"

namespace stationd::supervisor {

/// Whether a station that stands still is to be started.
enum class Intent : std::uint8_t {
  run,      ///< it is
  stopped,  ///< an operator stopped it: an operator starts it
  faulted   ///< it faulted while it was to run: an operator starts it
};
std::string_view name_of(Intent intent) noexcept;

struct SavedStation {
  Intent intent = Intent::run;
  PieceCount pieces;
  bool operator==(const SavedStation&) const = default;
};
using SavedState = std::map<std::string, SavedStation>;

/// The file's text: readable, one line per fact, with a first and a last line that show it is whole.
std::string encode(const SavedState& state);
/// Nothing if the text is damaged, cut short or of another version.
std::optional<SavedState> decode(std::string_view text);

class StateStore {
 public:
  StateStore() = default;
  StateStore(const StateStore&) = delete;
  StateStore& operator=(const StateStore&) = delete;
  virtual ~StateStore() = default;

  /// What was saved last; empty if nothing was or it cannot be read (then `problem` says why).
  virtual SavedState load(std::string& problem) = 0;
  /// Empty, or why it could not be saved (the former state is still whole then).
  [[nodiscard]] virtual std::string save(const SavedState& state) = 0;
};

/// Keeps nothing: an observer.
class NullStateStore final : public StateStore {
 public:
  SavedState load(std::string&) override { return {}; }
  std::string save(const SavedState&) override { return {}; }
};

/// For tests.
class MemoryStateStore final : public StateStore {
 public:
  SavedState load(std::string&) override { return state; }
  std::string save(const SavedState& wanted) override {
    state = wanted;
    ++saves;
    return {};
  }
  SavedState state;
  int saves = 0;
};

/// Another supervisor keeps its state in the same file.
class StateTaken : public SetupError {
 public:
  using SetupError::SetupError;
};

/// A file, replaced as a whole (write, sync, rename): never torn. A damaged one is kept as FILE.damaged.
/// Locks FILE.lock while it lives: two supervisors that keep the same file would undo each other's words.
class FileStateStore final : public StateStore {
 public:
  /// Makes the folder if it is missing. Throws SetupError (it cannot be written) or StateTaken.
  explicit FileStateStore(std::filesystem::path file);
  ~FileStateStore() override;
  SavedState load(std::string& problem) override;
  std::string save(const SavedState& state) override;

 private:
  std::filesystem::path file_;
  int lock_fd_ = -1;
};

}  // namespace stationd::supervisor

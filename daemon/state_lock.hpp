// StateLock: one daemon at a time for each controller, by a lock on a file in the state directory.
// Owned by the controller, or by --write-safe for its duration; the kernel lets go of it when the process
// ends.
// The main thread.
#pragma once

#include <filesystem>
#include <string>

namespace stationd {

class StateLock {
 public:
  /// Takes DIRECTORY/CONTROLLER.lock; makes the directory where it is missing.
  StateLock(const std::filesystem::path& directory, const std::string& controller);
  ~StateLock();
  StateLock(const StateLock&) = delete;
  StateLock& operator=(const StateLock&) = delete;

  bool held_by_other() const noexcept { return held_by_other_; }
  /// Why the file cannot be had at all; empty: it can.
  const std::string& error() const noexcept { return error_; }
  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
  std::string error_;
  bool held_by_other_ = false;
  int descriptor_ = -1;
};

}  // namespace stationd

// RetainStore: retained tags of one station in two generations on disk, written in turns; a torn write never
// hurts the older one.
// Owned by the daemon; one for each station.
// One plain thread at a time (set-up, then the retain thread); blocks for the disk's sync.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scan/error.hpp"
#include "scan/image.hpp"

namespace stationd {

/// The state directory, or a file in it, cannot be made or written.
class StateDirectoryError : public SetupError {
 public:
  using SetupError::SetupError;
};

/// What a store held at start.
struct RetainRecord {
  std::uint32_t epoch = 0;
  std::vector<Slot> slots;
};

/// A hash of names and types of the tags, in their order: a record of another layout is not taken.
std::uint64_t layout_hash(const Image& image, std::span<const TagIndex> tags);

/// Seam: where the retain thread saves a station's retained tags.
class RetainTarget {
 public:
  virtual ~RetainTarget() = default;
  /// Returns once they are safe. False: not saved (`error()` says why).
  virtual bool save(std::uint32_t epoch, std::span<const Slot> slots) = 0;
  virtual const std::string& error() const noexcept = 0;
};

class RetainStore final : public RetainTarget {
 public:
  /// Files are DIRECTORY/CONTROLLER.STATION.retained.0 and .1: controllers that share a directory may have
  /// stations of one name. Throws SetupError when the directory cannot be made or written.
  RetainStore(std::filesystem::path directory, const std::string& controller, const std::string& station,
              std::uint64_t layout);
  RetainStore(const RetainStore&) = delete;
  RetainStore& operator=(const RetainStore&) = delete;

  /// The newer valid record. Empty: none was ever written, or `refused` says why there is no usable one;
  /// files that could not be used are kept aside as *.refused. The epoch is told even from a record of
  /// another layout.
  struct Loaded {
    std::optional<RetainRecord> record;
    /// Of the newest readable record, 0: none. One more beside a damaged file, which may have been a start
    /// newer: no epoch is given out twice.
    std::uint32_t epoch = 0;
    std::string refused;  ///< for the log; empty: nothing to complain of
    std::string adopted;  ///< for the log: files of the old name that were taken over; empty: none
  };
  /// Before the first save(). Files that were named without the controller (STATION.retained.0) are renamed,
  /// once, where there are none of the new name.
  Loaded load();

  /// Writes the next generation and waits until it is on disk. False: not written (`error()` says why); the
  /// older record stays.
  bool save(std::uint32_t epoch, std::span<const Slot> slots) override;
  const std::string& error() const noexcept override { return error_; }

 private:
  std::filesystem::path path(int index) const;
  std::string adopt();
  std::string put_aside(int index, std::string_view why) const;

  std::filesystem::path directory_;
  std::string name_;      // of the files, without their number
  std::string old_name_;  // as they were named before
  std::uint64_t layout_;
  std::uint64_t generation_ = 0;  // of the newest record
  int next_ = 0;                  // file of the next one: never that of the newest valid record
  std::vector<std::byte> buffer_;
  std::string error_;
};

}  // namespace stationd

// DuplicateWatch: finds out that another daemon in the cell publishes the Status of one of our stations.
// Private to dds_bridge; owned by the bridge. Free of clock and DDS: time and samples are passed in.
// The bus-in thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "dds_bridge/bus.hpp"

namespace stationd::bus {

class DuplicateWatch {
 public:
  enum class Verdict : std::uint8_t {
    none,      ///< ours, or not yet sure
    give_way,  ///< we are the newcomer
    report     ///< we were here before, or both were for long: say so and go on
  };

  DuplicateWatch(Origin self, std::int64_t newcomer_ns) : self_(self), newcomer_ns_(newcomer_ns) {}

  void start(std::int64_t now_ns) { start_ns_ = now_ns; }
  /// A Status of a station of ours. Two different samples of one foreign writer are needed: one could be the
  /// last of a daemon that has just been killed and that this one replaces.
  Verdict on_status(const Status& status, const Origin& origin, std::int64_t now_ns);

 private:
  struct Writer {
    std::int64_t sequence = 0;
    int samples = 0;
  };
  bool own(const Origin& origin) const noexcept;

  Origin self_;
  std::int64_t newcomer_ns_;
  std::int64_t start_ns_ = 0;
  std::map<std::pair<std::uint64_t, std::uint64_t>, Writer> writers_;
};

}  // namespace stationd::bus

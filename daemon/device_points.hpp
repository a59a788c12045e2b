// DevicePoints: all points that the configuration puts on one device, and which of them are whose.
// A value made while building the controller (and by --write-safe).
// Set-up only.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "io/options.hpp"

namespace stationd {

/// Tags of one station that travel in one link to or from the device.
struct DeviceShare {
  std::size_t station = 0;  ///< index in the configuration
  io::Direction direction = io::Direction::input;
  std::int64_t stale_after_ns = 0;  ///< inputs: their common max_age
  std::vector<std::string> tags;
  std::vector<std::uint32_t> places;  ///< for each tag: its place among the device's input (output) points
};

class DevicePoints {
 public:
  DevicePoints(const config::Configuration& configuration, const std::string& device);

  const std::vector<io::Point>& all() const noexcept { return all_; }
  /// Inputs of one station and one max_age go together; all outputs of a station do.
  const std::vector<DeviceShare>& shares() const noexcept { return shares_; }

 private:
  void take(std::size_t station, const std::vector<config::TagMapping>& mappings, const std::string& device,
            std::uint32_t& count);
  DeviceShare& share(std::size_t station, const config::TagMapping& mapping);

  std::vector<io::Point> all_;
  std::vector<DeviceShare> shares_;
};

}  // namespace stationd

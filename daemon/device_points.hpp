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

class DevicePoints {
 public:
  DevicePoints(const config::Configuration& configuration, const std::string& device);

  const std::vector<io::Point>& all() const noexcept { return all_; }
  /// For each of the station's input (output) tags on the device, in the configuration's order: its place among the device's
  /// input (output) points.
  const std::vector<std::uint32_t>& inputs_of(std::size_t station) const { return inputs_[station]; }
  const std::vector<std::uint32_t>& outputs_of(std::size_t station) const { return outputs_[station]; }

 private:
  std::vector<io::Point> all_;
  std::vector<std::vector<std::uint32_t>> inputs_, outputs_;
};

}  // namespace stationd

#include "daemon/device_points.hpp"

namespace stationd {

DevicePoints::DevicePoints(const config::Configuration& configuration, const std::string& device) {
  std::uint32_t inputs = 0;
  std::uint32_t outputs = 0;
  const auto take = [&](const std::vector<config::TagMapping>& mappings, std::uint32_t& count) {
    std::vector<std::uint32_t> places;
    for (const config::TagMapping& m : mappings) {
      if (m.device != device) continue;
      all_.push_back(m.point);
      places.push_back(count++);
    }
    return places;
  };
  for (const config::StationConfig& s : configuration.stations) {
    inputs_.push_back(take(s.inputs, inputs));
    outputs_.push_back(take(s.outputs, outputs));
  }
}

}  // namespace stationd

#include "daemon/device_points.hpp"

namespace stationd {

DevicePoints::DevicePoints(const config::Configuration& configuration, const std::string& device) {
  std::uint32_t inputs = 0;
  std::uint32_t outputs = 0;
  for (std::size_t i = 0; i < configuration.stations.size(); ++i) {
    take(i, configuration.stations[i].inputs, device, inputs);
    take(i, configuration.stations[i].outputs, device, outputs);
  }
}

void DevicePoints::take(std::size_t station, const std::vector<config::TagMapping>& mappings,
                        const std::string& device, std::uint32_t& count) {
  for (const config::TagMapping& m : mappings) {
    if (m.device != device) continue;
    all_.push_back(m.point);
    DeviceShare& mine = share(station, m);
    mine.tags.push_back(m.tag);
    mine.places.push_back(count++);
  }
}

DeviceShare& DevicePoints::share(std::size_t station, const config::TagMapping& mapping) {
  const io::Direction direction = mapping.point.direction;
  const std::int64_t age_ns = direction == io::Direction::input ? mapping.max_age_ns : 0;
  for (DeviceShare& s : shares_)
    if (s.station == station && s.direction == direction && s.stale_after_ns == age_ns) return s;
  shares_.push_back({station, direction, age_ns, {}, {}});
  return shares_.back();
}

}  // namespace stationd

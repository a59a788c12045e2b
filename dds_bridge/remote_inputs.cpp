#include "dds_bridge/remote_inputs.hpp"

#include <algorithm>

namespace stationd::bus {

void RemoteInputs::add(Station& station) {
  for (const auto& link : station.bus_inputs()) {
    const std::string what = "station " + station.name() + ", bus input " + link->source;
    const std::size_t slash = link->source.find('/');
    const TopicInfo* info = find_topic(link->source.substr(0, slash));
    if (slash == std::string::npos || info == nullptr || info->service != Service::pv) {
      throw BusError(what + ": expected Set, End or Status, a slash and a station's name");
    }
    links_.push_back({link.get(), info->id, link->source.substr(slash + 1),
                      map_fields(*info->type, link->members, link->tags, station.image(), true, what)});
  }
}

bool RemoteInputs::wants(TopicId topic) const noexcept {
  return std::ranges::any_of(links_, [&](const Link& link) { return link.topic == topic; });
}

std::vector<std::string> RemoteInputs::stations() const {
  std::vector<std::string> names;
  for (const Link& link : links_) {
    if (std::ranges::find(names, link.station) == names.end()) names.push_back(link.station);
  }
  return names;
}

void RemoteInputs::put(TopicId topic, const std::string& station, const void* object,
                       std::int64_t receipt_ns) {
  for (Link& to : links_) {
    if (to.topic != topic || to.station != station) continue;
    const BlockView block{to.link->blocks.writable(), to.link->tags.layout};
    for (const FieldMap& map : to.maps) load(map, object, block.slots().data());
    std::ranges::fill(block.qualities(), Quality::GOOD);
    block.header() = {receipt_ns, 0, 0, ++to.count, Quality::GOOD};
    to.link->blocks.publish();
  }
}

}  // namespace stationd::bus

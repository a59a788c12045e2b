// Set-up of a station: tags into the image, links for devices, bus and retained data.
#include "scan/station.hpp"

#include <algorithm>

#include "scan/error.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kBusStaleNs = 1'000'000'000;
constexpr std::int64_t kBusBadNs = 5'000'000'000;

}  // namespace

Station::Station(StationOptions options, std::unique_ptr<Program> program)
    : options_(std::move(options)), program_(std::move(program)),
      port_(options_.request_capacity, options_.event_capacity) {
  for (Handle* handle : program_->handles()) image_.add(handle->spec());
  running_tag_ =
      image_.add(tag_spec<bool>("station.running", Area::retained, "Whether the station was running"));
  for (const PvSubscription& s : program_->subscriptions()) {
    for (const PvMember& m : s.members)
      if (m.handle->spec().area != Area::input)
        throw SetupError("tag " + options_.name + "." + m.handle->spec().name + " takes topic " + s.topic +
                         " and is no input");
    auto link =
        std::make_unique<InputLink>(s.topic + "/" + s.station, link_tags(s.members), kBusStaleNs, kBusBadNs);
    for (const PvMember& m : s.members) link->members.push_back(m.name);
    bus_inputs_.push_back(std::move(link));
  }
  for (const PvPublication& p : program_->publications()) {
    std::vector<std::string> names;
    for (const PvMember& m : p.members) names.push_back(m.name);
    pvs_.push_back(
        std::make_unique<PvLink>(p.topic, link_tags(p.members), std::move(names), options_.pv_heartbeat_ns));
  }
}

Station::~Station() = default;

LinkTags Station::link_tags(const std::vector<PvMember>& members) const {
  LinkTags result;
  for (const PvMember& m : members) {
    const auto tag = image_.find(m.handle->spec().name);
    if (!tag) throw SetupError("station " + options_.name + " has no tag \"" + m.handle->spec().name + "\"");
    result.tags.push_back(*tag);
    result.layout.slots += image_.slot_count(result.tags.back());
  }
  result.layout.tags = static_cast<std::uint32_t>(result.tags.size());
  return result;
}

LinkTags Station::link_tags(const std::vector<std::string>& names, Area area) const {
  LinkTags result;
  for (const std::string& name : names) {
    const auto tag = image_.find(name);
    if (!tag) throw SetupError("station " + options_.name + " has no tag \"" + name + "\"");
    if (image_.spec(*tag).area != area)
      throw SetupError("tag " + options_.name + "." + name + " is of area " +
                       std::string(name_of(image_.spec(*tag).area)) + ", not " + std::string(name_of(area)));
    result.tags.push_back(*tag);
    result.layout.slots += image_.slot_count(*tag);
  }
  result.layout.tags = static_cast<std::uint32_t>(result.tags.size());
  return result;
}

InputLink& Station::add_device_inputs(const std::string& device, const std::vector<std::string>& tags,
                                      std::int64_t stale_after_ns, std::int64_t bad_after_ns) {
  require_unsealed();
  device_inputs_.push_back(
      std::make_unique<InputLink>(device, link_tags(tags, Area::input), stale_after_ns, bad_after_ns));
  return *device_inputs_.back();
}

OutputLink& Station::add_device_outputs(const std::string& device, const std::vector<std::string>& tags) {
  require_unsealed();
  device_outputs_.push_back(std::make_unique<OutputLink>(device, link_tags(tags, Area::output)));
  return *device_outputs_.back();
}

void Station::require_unsealed() const {
  if (sealed_) throw SetupError("station " + options_.name + " is sealed");
}

void Station::set_bus_limits(std::int64_t stale_after_ns, std::int64_t bad_after_ns) {
  require_unsealed();
  for (auto& link : bus_inputs_) {
    auto changed = std::make_unique<InputLink>(link->source, link->tags, stale_after_ns, bad_after_ns);
    changed->members = link->members;
    link = std::move(changed);
  }
}

void Station::bind() {
  TagIndex tag = 0;
  for (Handle* handle : program_->handles()) {
    handle->bind(image_.value(tag), image_.quality(tag));
    ++tag;
  }
}

void Station::seal() {
  require_unsealed();
  sealed_ = true;
  image_.seal();
  bind();
  LinkTags all, retained;
  for (TagIndex tag = 0; tag < image_.size(); ++tag) {
    all.tags.push_back(tag);
    all.layout.slots += image_.slot_count(tag);
    if (image_.spec(tag).area == Area::output) set_up_output(tag);
    if (image_.spec(tag).area != Area::retained) continue;
    retained.tags.push_back(tag);
    retained.layout.slots += image_.slot_count(tag);
  }
  retained.layout.tags = static_cast<std::uint32_t>(retained.tags.size());
  all.layout.tags = static_cast<std::uint32_t>(all.tags.size());
  image_copy_ = std::make_unique<ImageCopy>(std::move(all));
  retained_sent_.assign(retained.layout.slots, 0);
  retain_ = std::make_unique<RetainLink>(std::move(retained));
  for (const auto& pv : pvs_) pv_sent_.emplace_back(pv->tags.layout.slots, 0);
  pv_sent_ns_.assign(pvs_.size(), 0);
  pv_count_.assign(pvs_.size(), 0);
  output_count_.assign(device_outputs_.size(), 0);
}

void Station::set_up_output(TagIndex tag) {
  const TagSpec& spec = image_.spec(tag);
  *image_.value(tag) = spec.safe;
  if (!spec.hold) {
    safe_outputs_.push_back({tag, spec.safe});
    return;
  }
  held_outputs_.push_back(tag);
  held_.resize(held_.size() + image_.slot_count(tag));
}

void Station::restore(std::span<const Slot> slots) {
  if (!sealed_) throw SetupError("station " + options_.name + " is restored before it is sealed");
  if (slots.size() != retain_->tags.layout.slots)
    throw SetupError("station " + options_.name + ": retained record has " + std::to_string(slots.size()) +
                     " slots, " + std::to_string(retain_->tags.layout.slots) + " expected");
  std::size_t next = 0;
  for (const TagIndex tag : retain_->tags.tags)
    for (std::uint32_t i = 0; i < image_.slot_count(tag); ++i) image_.value(tag)[i] = slots[next++];
  std::copy(slots.begin(), slots.end(), retained_sent_.begin());
  restart_ = Restart::warm;
  const bool was_running = *image_.value(running_tag_) != 0;
  resuming_ = was_running && options_.on_restart == OnRestart::resume;
  *image_.value(running_tag_) = resuming_ ? 1 : 0;
}

}  // namespace stationd

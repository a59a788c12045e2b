#include "dds_bridge/writers.hpp"

#include <utility>

#include "dds_bridge/qos.hpp"
#include "dds_bridge/topic_type.hpp"

namespace stationd::bus {

std::string policy_name(std::uint32_t policy) {
  static constexpr std::array<const char*, 25> names = {"INVALID",
                                                        "USERDATA",
                                                        "DURABILITY",
                                                        "PRESENTATION",
                                                        "DEADLINE",
                                                        "LATENCYBUDGET",
                                                        "OWNERSHIP",
                                                        "OWNERSHIPSTRENGTH",
                                                        "LIVELINESS",
                                                        "TIMEBASEDFILTER",
                                                        "PARTITION",
                                                        "RELIABILITY",
                                                        "DESTINATIONORDER",
                                                        "HISTORY",
                                                        "RESOURCELIMITS",
                                                        "ENTITYFACTORY",
                                                        "WRITERDATALIFECYCLE",
                                                        "READERDATALIFECYCLE",
                                                        "TOPICDATA",
                                                        "GROUPDATA",
                                                        "TRANSPORTPRIORITY",
                                                        "LIFESPAN",
                                                        "DURABILITYSERVICE",
                                                        "DATAREPRESENTATION",
                                                        "TYPECONSISTENCYENFORCEMENT"};
  return policy < names.size() ? names[policy] : "policy " + std::to_string(policy);
}

Writers::~Writers() {
  for (auto& slot : writers_) {
    auto* made = slot.exchange(nullptr);
    if (made != nullptr) participant_.publisher().delete_datawriter(made);
  }
}

compat::dds::DataWriter& Writers::writer(TopicId id) {
  auto& slot = writers_[static_cast<std::size_t>(id)];
  if (auto* made = slot.load(std::memory_order_acquire)) return *made;
  const std::lock_guard lock(making_);
  auto* made = slot.load(std::memory_order_relaxed);
  if (made == nullptr) {
    const TopicInfo& info = topic(id);
    made = participant_.publisher().create_datawriter(&participant_.topic(id),
                                                      writer_qos(info.service, participant_.options));
    if (made == nullptr)
      throw BusError("DDS writer of topic " + std::string(info.name) + " could not be created");
    slot.store(made, std::memory_order_release);
  }
  return *made;
}

void Writers::prepare(TopicId id) { writer(id); }

bool Writers::write(TopicId id, const void* object) noexcept {
  bool written = false;
  try {
    const Sample sample{const_cast<void*>(object), true};  // only read
    written = compat::write(writer(id), &sample) == compat::kOk;
  } catch (...) {  // no writer, or the library threw: not written
  }
  if (!written) failures_.fetch_add(1, std::memory_order_relaxed);
  return written;
}

bool Writers::write_related(TopicId id, const void* object, const Origin* related,
                            Origin* identity) noexcept {
  bool written = false;
  try {
    const Sample sample{const_cast<void*>(object), true};  // only read
    compat::rtps::WriteParams params;
    if (related != nullptr && (related->writer_high != 0 || related->writer_low != 0)) {
      compat::rtps::SampleIdentity answered;
      answered.writer_guid(guid_of(*related));
      answered.sequence_number(
          compat::rtps::SequenceNumber_t(static_cast<std::int32_t>(related->sequence >> 32U),
                                         static_cast<std::uint32_t>(related->sequence)));
      params.related_sample_identity(answered);
    }
    written = compat::write(writer(id), &sample, params);
    if (written && identity != nullptr) {
      put_guid(params.sample_identity().writer_guid(), *identity);
      identity->sequence = static_cast<std::int64_t>(params.sample_identity().sequence_number().to64long());
    }
  } catch (...) {  // as above
  }
  if (!written) failures_.fetch_add(1, std::memory_order_relaxed);
  return written;
}

int Writers::matched(TopicId id) const {
  const auto* made = writers_[static_cast<std::size_t>(id)].load(std::memory_order_acquire);
  if (made == nullptr) return 0;
  compat::dds::PublicationMatchedStatus status;
  static_cast<void>(const_cast<compat::dds::DataWriter*>(made)->get_publication_matched_status(status));
  return status.current_count;
}

void Writers::describe(std::vector<EndpointQos>& list) const {
  for (std::size_t i = 0; i < kTopics; ++i) {
    const auto* made = writers_[i].load(std::memory_order_acquire);
    if (made != nullptr) list.push_back(read_back(topics()[i].name, *made));
  }
}

void Writers::report_incompatible(const std::function<void(const std::string&, const std::string&)>& report) {
  for (std::size_t i = 0; i < kTopics; ++i) {
    auto* made = writers_[i].load(std::memory_order_acquire);
    if (made == nullptr) continue;
    compat::dds::OfferedIncompatibleQosStatus status;
    static_cast<void>(made->get_offered_incompatible_qos_status(status));
    if (status.total_count_change > 0)
      report(std::string(topics()[i].name), policy_name(status.last_policy_id));
  }
}

}  // namespace stationd::bus

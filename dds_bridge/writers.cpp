#include "dds_bridge/writers.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "dds_bridge/qos.hpp"
#include "dds_bridge/topic_type.hpp"
#include "scan/clock.hpp"

namespace stationd::bus {
namespace {

constexpr std::array<std::uint8_t, 2> kFastDdsVendor = {0x01, 0x0F};  // a GUID begins with its vendor
constexpr std::int64_t kSettleNs = 100'000'000;
constexpr std::int64_t kReplyWaitNs = 500'000'000;
constexpr std::size_t kMostWaiting = 1024;

}  // namespace

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

void ReplyReaders::on_publication_matched(compat::dds::DataWriter*,
                                          const compat::dds::PublicationMatchedStatus& status) {
  Prefix prefix{};
  for (std::size_t i = 0; i < prefix.size(); ++i) prefix[i] = status.last_subscription_handle.value[i];
  const std::lock_guard lock(mutex_);
  Peer& peer = peers_[prefix];
  peer.readers += status.current_count_change;
  if (peer.readers <= 0) peers_.erase(prefix);
}

bool ReplyReaders::ready(const Origin& origin, std::int64_t now_ns) {
  const compat::rtps::GUID_t guid = guid_of(origin);
  Prefix prefix{};
  for (std::size_t i = 0; i < prefix.size(); ++i) prefix[i] = guid.guidPrefix.value[i];
  const std::lock_guard lock(mutex_);
  const auto found = peers_.find(prefix);
  if (found == peers_.end()) return false;
  if (prefix[0] == kFastDdsVendor[0] && prefix[1] == kFastDdsVendor[1]) return true;
  Peer& peer = found->second;
  if (peer.asked_ns == 0) peer.asked_ns = now_ns;
  return now_ns - peer.asked_ns >= kSettleNs;
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
    made = participant_.publisher().create_datawriter(
        &participant_.topic(id), writer_qos(info.service, participant_.options),
        id == TopicId::reply ? &reply_readers_ : nullptr,
        id == TopicId::reply ? compat::dds::StatusMask::publication_matched()
                             : compat::dds::StatusMask::none());
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

bool Writers::write_reply(const MsgRes& reply, const Origin& related) noexcept try {
  const bool asked_by_somebody = related.writer_high != 0 || related.writer_low != 0;
  if (asked_by_somebody && !reply_readers_.ready(related, monotonic_ns())) {
    const std::lock_guard lock(waiting_mutex_);
    if (waiting_.size() >= kMostWaiting) return false;
    waiting_.push_back({reply, related, monotonic_ns() + kReplyWaitNs});
    return true;
  }
  return write_related(TopicId::reply, &reply, &related, nullptr);
} catch (...) {
  return false;
}

void Writers::flush_replies(std::int64_t now_ns) noexcept try {
  std::vector<Waiting> due;
  {
    const std::lock_guard lock(waiting_mutex_);
    const auto first = std::stable_partition(waiting_.begin(), waiting_.end(), [&](const Waiting& waiting) {
      return now_ns < waiting.until_ns && !reply_readers_.ready(waiting.related, now_ns);
    });
    due.assign(std::make_move_iterator(first), std::make_move_iterator(waiting_.end()));
    waiting_.erase(first, waiting_.end());
  }
  // Without the lock: a write may block, and the bus-out thread adds to those that wait.
  for (const Waiting& waiting : due) write_related(TopicId::reply, &waiting.reply, &waiting.related, nullptr);
} catch (...) {  // no memory to look at them: next time
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

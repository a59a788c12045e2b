#include "dds_bridge/participant.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <pthread.h>
#include <sched.h>
#include <time.h>

#include <algorithm>
#include <memory>
#include <mutex>

#include "dds_bridge/qos.hpp"
#include "dds_bridge/topic_type.hpp"

namespace stationd::bus {
namespace {

constexpr int kHighestDomain = 99;
constexpr std::size_t kPrefixBytes = 12, kGuidBytes = 16, kHighBytes = 8;

/// The machine's IPv4 addresses.
std::vector<std::string> local_addresses() {
  std::vector<std::string> addresses;
  ifaddrs* raw = nullptr;
  if (getifaddrs(&raw) != 0) return addresses;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> list(raw, &freeifaddrs);
  for (const ifaddrs* entry = list.get(); entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    const auto* address = reinterpret_cast<const sockaddr_in*>(static_cast<const void*>(entry->ifa_addr));
    std::array<char, INET_ADDRSTRLEN> text{};
    if (inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size()) != nullptr) {
      addresses.emplace_back(text.data());
    }
  }
  return addresses;
}

void check_interfaces(const std::vector<std::string>& interfaces) {
  const std::vector<std::string> have = local_addresses();
  for (const std::string& wanted : interfaces) {
    if (std::ranges::find(have, wanted) != have.end()) continue;
    std::string text =
        "no DDS network: this machine has no interface with the address " + wanted + " (it has";
    for (const std::string& address : have) text += " " + address;
    throw BusError(text + (have.empty() ? " none)" : ")"));
  }
}

void check_thread() {
  int policy = SCHED_OTHER;
  sched_param param{};
  if (pthread_getschedparam(pthread_self(), &policy, &param) == 0 &&
      (policy == SCHED_FIFO || policy == SCHED_RR)) {
    throw BusError(
        "DDS entities must not be created by a real-time thread: the library's threads inherit its priority");
  }
}

}  // namespace

void put_guid(const compat::rtps::GUID_t& guid, Origin& origin) noexcept {
  origin.writer_high = 0;
  origin.writer_low = 0;
  for (std::size_t i = 0; i < kGuidBytes; ++i) {
    const std::uint64_t byte =
        i < kPrefixBytes ? guid.guidPrefix.value[i] : guid.entityId.value[i - kPrefixBytes];
    std::uint64_t& half = i < kHighBytes ? origin.writer_high : origin.writer_low;
    half = (half << 8U) | byte;
  }
}

compat::rtps::GUID_t guid_of(const Origin& origin) noexcept {
  compat::rtps::GUID_t guid;
  for (std::size_t i = 0; i < kGuidBytes; ++i) {
    const std::uint64_t half = i < kHighBytes ? origin.writer_high : origin.writer_low;
    const auto byte = static_cast<std::uint8_t>(half >> (8U * (kHighBytes - 1 - i % kHighBytes)));
    if (i < kPrefixBytes)
      guid.guidPrefix.value[i] = byte;
    else
      guid.entityId.value[i - kPrefixBytes] = byte;
  }
  return guid;
}

Participant::Participant(Options wanted) : options(std::move(wanted)) {
  if (options.domain < 0 || options.domain > kHighestDomain) {
    throw BusError("DDS domain " + std::to_string(options.domain) +
                   " is not allowed: 0 to 99 (the ports of higher ones "
                   "are handed out by the system to other programs)");
  }
  check_thread();
  check_interfaces(options.interfaces);
  try {
    create();
  } catch (...) {
    destroy();
    throw;
  }
}

Participant::~Participant() { destroy(); }

void Participant::create() {
  static std::once_flag once;
  std::call_once(once, compat::set_library_defaults);
  auto* factory = compat::dds::DomainParticipantFactory::get_instance();
  participant_ =
      factory->create_participant(static_cast<std::uint32_t>(options.domain), participant_qos(options));
  if (participant_ == nullptr) {
    throw BusError("no DDS network: the participant for domain " + std::to_string(options.domain) +
                   " could not be created (are the UDP ports in use, or are there too many participants?)");
  }
  Origin origin;
  put_guid(participant_->guid(), origin);
  prefix_high_ = origin.writer_high;
  prefix_low_ = static_cast<std::uint32_t>(origin.writer_low >> 32U);
  if (compat::number_of(participant_->register_content_filter_factory(kKeyFilterClass, &filters_)) !=
      compat::kOk) {
    throw BusError("the DDS content filter class could not be registered");
  }
  compat::dds::PublisherQos publisher_qos;
  publisher_qos.partition().push_back(options.cell.c_str());
  publisher_ = participant_->create_publisher(publisher_qos);
  compat::dds::SubscriberQos subscriber_qos;
  subscriber_qos.partition().push_back(options.cell.c_str());
  subscriber_ = participant_->create_subscriber(subscriber_qos);
  if (publisher_ == nullptr || subscriber_ == nullptr) {
    throw BusError("DDS publisher or subscriber could not be created in partition " + options.cell);
  }
  for (const TopicInfo& info : bus::topics()) {
    compat::dds::TypeSupport type(new TopicType(*info.type));
    compat::without_type_information(type);
    const std::string type_name(info.type->name), name(info.name);
    // Registering the same type once more (three topics share Msg_Req) finds it there and is no error.
    if (participant_->find_type(type_name).empty()) type.register_type(participant_);
    auto*& made = topics_[static_cast<std::size_t>(info.id)];
    made = participant_->create_topic(name, type_name, compat::dds::TOPIC_QOS_DEFAULT);
    if (made == nullptr) throw BusError("DDS topic " + name + " could not be created");
  }
}

void Participant::destroy() noexcept try {
  if (participant_ == nullptr) return;
  for (auto*& made : topics_) {
    if (made != nullptr) participant_->delete_topic(made);
    made = nullptr;
  }
  if (publisher_ != nullptr) participant_->delete_publisher(publisher_);
  if (subscriber_ != nullptr) participant_->delete_subscriber(subscriber_);
  participant_->unregister_content_filter_factory(kKeyFilterClass);
  compat::dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  participant_ = nullptr;
} catch (...) {  // nobody is left who could do anything about it
}

}  // namespace stationd::bus

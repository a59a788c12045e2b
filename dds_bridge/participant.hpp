// Participant: the DDS participant of a Bus with its publisher, subscriber, types and topics, and their clean
// end.
// Private to dds_bridge; owned by the Bus, outlives all its readers and writers.
// Set up and destroyed by one plain thread.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "dds_bridge/bus.hpp"
#include "dds_bridge/cell_types.hpp"
#include "dds_bridge/compat.hpp"
#include "dds_bridge/key_filter.hpp"

namespace stationd::bus {

class Participant {
 public:
  /// Throws BusError.
  explicit Participant(Options options);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  const Options options;
  std::atomic<std::uint64_t> malformed{0};

  compat::dds::DomainParticipant& dds() noexcept { return *participant_; }
  compat::dds::Publisher& publisher() noexcept { return *publisher_; }
  compat::dds::Subscriber& subscriber() noexcept { return *subscriber_; }
  compat::dds::Topic& topic(TopicId id) noexcept { return *topics_[static_cast<std::size_t>(id)]; }
  /// The first 12 bytes of the GUIDs of all its endpoints, as Origin holds them.
  std::uint64_t prefix_high() const noexcept { return prefix_high_; }
  std::uint32_t prefix_low() const noexcept { return prefix_low_; }

 private:
  void create();
  void destroy() noexcept;

  KeyFilterFactory filters_;
  compat::dds::DomainParticipant* participant_ = nullptr;
  compat::dds::Publisher* publisher_ = nullptr;
  compat::dds::Subscriber* subscriber_ = nullptr;
  std::array<compat::dds::Topic*, kTopics> topics_{};
  std::uint64_t prefix_high_ = 0;
  std::uint32_t prefix_low_ = 0;
};

/// A GUID as the two numbers of Origin.
void put_guid(const compat::rtps::GUID_t& guid, Origin& origin) noexcept;
compat::rtps::GUID_t guid_of(const Origin& origin) noexcept;

}  // namespace stationd::bus

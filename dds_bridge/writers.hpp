// Writers: the DDS writers of a Bus, one per topic, made at first use.
// Private to dds_bridge; owned by the Bus.
// Any plain thread.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "dds_bridge/participant.hpp"

namespace stationd::bus {

class Writers {
 public:
  explicit Writers(Participant& participant) : participant_(participant) {}
  ~Writers();
  Writers(const Writers&) = delete;
  Writers& operator=(const Writers&) = delete;

  /// Throws BusError when the writer cannot be made.
  void prepare(TopicId id);
  /// False: refused, counted. `object` is the message's struct.
  bool write(TopicId id, const void* object) noexcept;
  /// With a relation to another sample; returns the own identity in `identity`.
  bool write_related(TopicId id, const void* object, const Origin* related, Origin* identity) noexcept;
  int matched(TopicId id) const;
  std::uint64_t failures() const noexcept { return failures_.load(std::memory_order_relaxed); }
  void describe(std::vector<EndpointQos>& list) const;
  /// Tells each incompatible reader that turned up since the last call: topic, policy.
  void report_incompatible(const std::function<void(const std::string&, const std::string&)>& report);

 private:
  compat::dds::DataWriter& writer(TopicId id);

  Participant& participant_;
  std::mutex making_;
  std::array<std::atomic<compat::dds::DataWriter*>, kTopics> writers_{};
  std::atomic<std::uint64_t> failures_{0};
};

/// Name of a QoS policy by its number in DDS.
std::string policy_name(std::uint32_t policy);

}  // namespace stationd::bus

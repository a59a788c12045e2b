// Readers: the DDS readers of a Bus and its bus-in thread, which takes every sample and hands it to the
// handlers.
// Private to dds_bridge; owned by the Bus.
// Made and stopped by a plain thread; everything else in the bus-in thread.
#pragma once

#include <array>
#include <cstdint>
#include <fastdds/dds/core/condition/GuardCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "dds_bridge/order_numbers.hpp"
#include "dds_bridge/participant.hpp"
#include "dds_bridge/topic_type.hpp"
#include "dds_bridge/writers.hpp"

namespace stationd::bus {

class Readers {
 public:
  /// Makes the readers that the handlers ask for. Throws BusError.
  Readers(Participant& participant, Writers& writers, Handlers handlers);
  ~Readers();
  Readers(const Readers&) = delete;
  Readers& operator=(const Readers&) = delete;

  /// Starts the bus-in thread.
  void start();
  /// Stops and joins it.
  void stop() noexcept;
  void describe(std::vector<EndpointQos>& list) const;

 private:
  struct Slot {
    compat::dds::DataReader* reader = nullptr;
    compat::dds::ContentFilteredTopic* filtered = nullptr;
    // For take(): one sample, and the key that the last one had.
    compat::dds::LoanableSequence<Sample> sample;
    compat::dds::SampleInfoSeq info;
    compat::rtps::InstanceHandle_t last;
  };
  enum class Took : std::uint8_t { nothing, sample, dropped };

  void make(TopicId id, bool wanted, const std::vector<std::string>& names);
  void destroy() noexcept;
  void run();
  bool round();
  bool drain_orders();
  std::size_t take_orders(TopicId id, std::size_t most, std::vector<ReceivedOrder>& orders);
  template <class T, class Handler> bool take_some(TopicId id, const Handler& handler);
  Took take(TopicId id, void* object, compat::dds::SampleInfo& info) noexcept;
  template <class Call> void guarded(const Call& call) noexcept;
  void watch_matches();
  Slot& slot(TopicId id) { return slots_[static_cast<std::size_t>(id)]; }

  Participant& participant_;
  Writers& writers_;
  const Handlers handlers_;
  std::array<Slot, kTopics> slots_{};
  compat::dds::WaitSet waits_;
  compat::dds::GuardCondition end_;
  std::vector<ReceivedOrder> stops_, starts_;
  OrderNumbers numbers_;
  std::thread thread_;
};

}  // namespace stationd::bus

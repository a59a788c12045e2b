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

#include "dds_bridge/participant.hpp"
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
  };
  struct Order {
    MsgReq message;
    Origin origin;
    std::int64_t received = 0;  // by the library's clock
  };
  enum class Took : std::uint8_t { nothing, sample, dropped };

  void make(TopicId id, bool wanted, const std::vector<std::string>& names);
  void destroy() noexcept;
  void run();
  bool round();
  bool drain_orders();
  bool take_orders(TopicId id, std::vector<Order>& orders);
  void number_orders();
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
  std::vector<Order> stops_, starts_;
  std::uint64_t order_ = 0;
  std::thread thread_;
};

}  // namespace stationd::bus

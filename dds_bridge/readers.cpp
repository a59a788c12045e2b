#include "dds_bridge/readers.hpp"

#include <pthread.h>

#include <algorithm>
#include <utility>

#include "dds_bridge/qos.hpp"
#include "scan/clock.hpp"

namespace stationd::bus {
namespace {

constexpr std::int64_t kWatchPeriod = 100'000'000;  // matches and incompatible peers are looked at so often
constexpr std::size_t kBurst = 16;  // samples of one topic in its turn; then Stop is looked at again
constexpr std::size_t kStops = 64;  // Stops taken at once

Origin origin_of(const compat::dds::SampleInfo& info) noexcept {
  Origin origin;
  origin.receipt_ns = monotonic_ns();
  put_guid(info.sample_identity.writer_guid(), origin);
  origin.sequence = static_cast<std::int64_t>(info.sample_identity.sequence_number().to64long());
  return origin;
}

Origin related_of(const compat::dds::SampleInfo& info) noexcept {
  Origin origin;
  if (info.related_sample_identity.writer_guid() == compat::rtps::GUID_t::unknown()) return origin;
  put_guid(info.related_sample_identity.writer_guid(), origin);
  origin.sequence = static_cast<std::int64_t>(info.related_sample_identity.sequence_number().to64long());
  return origin;
}

}  // namespace

Readers::Readers(Participant& participant, Writers& writers, Handlers handlers)
    : participant_(participant), writers_(writers), handlers_(std::move(handlers)) {
  try {
    make(TopicId::stop, bool(handlers_.on_stop), handlers_.names);
    make(TopicId::start, bool(handlers_.on_start), handlers_.names);
    make(TopicId::gse, bool(handlers_.on_gse), {});
    make(TopicId::set, bool(handlers_.on_set), handlers_.stations);
    make(TopicId::end, bool(handlers_.on_end), handlers_.stations);
    make(TopicId::status, bool(handlers_.on_status), handlers_.stations);
    make(TopicId::stats, bool(handlers_.on_stats), handlers_.stations);
    make(TopicId::request, bool(handlers_.on_request), handlers_.names);
    make(TopicId::reply, bool(handlers_.on_reply), handlers_.names);
    waits_.attach_condition(end_);
  } catch (...) {
    destroy();
    throw;
  }
}

Readers::~Readers() {
  stop();
  destroy();
}

void Readers::destroy() noexcept {
  for (Slot& made : slots_) {
    if (made.reader != nullptr) {
      static_cast<void>(waits_.detach_condition(made.reader->get_statuscondition()));
      static_cast<void>(participant_.subscriber().delete_datareader(made.reader));
    }
    if (made.filtered != nullptr)
      static_cast<void>(participant_.dds().delete_contentfilteredtopic(made.filtered));
    made.reader = nullptr;
    made.filtered = nullptr;
  }
}

void Readers::make(TopicId id, bool wanted, const std::vector<std::string>& names) {
  if (!wanted) return;
  const TopicInfo& info = topic(id);
  const std::string name(info.name);
  Slot& made = slot(id);
  compat::dds::TopicDescription* source = &participant_.topic(id);
  if (!names.empty() && !info.filter_member.empty()) {
    made.filtered = participant_.dds().create_contentfilteredtopic(
        name + " of " + participant_.options.name, &participant_.topic(id),
        key_filter_expression(info.filter_member, names.size()), key_filter_parameters(names),
        kKeyFilterClass);
    if (made.filtered == nullptr)
      throw BusError("DDS content filter for topic " + name + " could not be created");
    source = made.filtered;
  }
  made.reader = participant_.subscriber().create_datareader(
      source, reader_qos(info.service, participant_.options), nullptr, compat::dds::StatusMask::none());
  if (made.reader == nullptr) throw BusError("DDS reader of topic " + name + " could not be created");
  made.reader->get_statuscondition().set_enabled_statuses(compat::dds::StatusMask::data_available());
  waits_.attach_condition(made.reader->get_statuscondition());
}

void Readers::start() {
  thread_ = std::thread([this] { run(); });
}

void Readers::stop() noexcept {
  if (!thread_.joinable()) return;
  end_.set_trigger_value(true);
  thread_.join();
}

void Readers::describe(std::vector<EndpointQos>& list) const {
  for (std::size_t i = 0; i < kTopics; ++i) {
    if (slots_[i].reader != nullptr) list.push_back(read_back(topics()[i].name, *slots_[i].reader));
  }
}

void Readers::run() {
  pthread_setname_np(pthread_self(), "bus-in");
  std::int64_t watched_ns = 0;
  bool more = false;  // a take ends a reader's wake-up, though samples may be left
  while (!end_.get_trigger_value()) {
    compat::dds::ConditionSeq active;
    if (!more) static_cast<void>(waits_.wait(active, compat::duration(kWatchPeriod)));
    more = round();
    const std::int64_t now_ns = monotonic_ns();
    writers_.flush_replies(now_ns);
    if (now_ns - watched_ns < kWatchPeriod) continue;
    watched_ns = now_ns;
    watch_matches();
  }
}

/// One turn for each reader, at most a burst long, so that a flood on one topic costs the others only that;
/// true if any had a sample. Stop comes first and again between the turns.
bool Readers::round() {
  bool any = drain_orders();
  any |= take_some<Gse>(TopicId::gse, handlers_.on_gse);
  any |= drain_orders();
  any |= take_some<Set>(TopicId::set, handlers_.on_set);
  any |= take_some<End>(TopicId::end, handlers_.on_end);
  any |= take_some<Status>(TopicId::status, handlers_.on_status);
  any |= take_some<ScanStats>(TopicId::stats, handlers_.on_stats);
  any |= drain_orders();
  any |= take_some<MsgReq>(TopicId::request, handlers_.on_request);
  any |= drain_orders();
  Slot& reply = slot(TopicId::reply);
  MsgRes message;
  compat::dds::SampleInfo info;
  for (std::size_t i = 0; reply.reader != nullptr && i < kBurst; ++i) {
    const Took took = take(TopicId::reply, &message, info);
    if (took == Took::nothing) break;
    any = true;
    if (took == Took::sample)
      guarded([&] { handlers_.on_reply(message, origin_of(info), related_of(info)); });
  }
  return any;
}

/// Stops are handed out before Starts, whatever waits; their numbers say in which order they were received.
bool Readers::drain_orders() {
  stops_.clear();
  starts_.clear();
  const std::size_t stops = take_orders(TopicId::stop, kStops, stops_);
  // After the Stops: what is taken later cannot have been sent before.
  const std::size_t starts = take_orders(TopicId::start, kBurst, starts_);
  numbers_.number(stops_, starts_, starts == kBurst);
  for (const ReceivedOrder& order : stops_) guarded([&] { handlers_.on_stop(order.message, order.origin); });
  for (const ReceivedOrder& order : starts_)
    guarded([&] { handlers_.on_start(order.message, order.origin); });
  return stops + starts > 0;
}

/// How many were taken, readable or not.
std::size_t Readers::take_orders(TopicId id, std::size_t most, std::vector<ReceivedOrder>& orders) {
  if (slot(id).reader == nullptr) return 0;
  compat::dds::SampleInfo info;
  for (std::size_t i = 0; i < most; ++i) {
    ReceivedOrder order;
    const Took took = take(id, &order.message, info);
    if (took == Took::nothing) return i;
    if (took != Took::sample) continue;
    order.origin = origin_of(info);
    order.received = info.reception_timestamp.to_ns();
    orders.push_back(std::move(order));
  }
  return most;
}

template <class T, class Handler> bool Readers::take_some(TopicId id, const Handler& handler) {
  if (slot(id).reader == nullptr) return false;
  T message;
  compat::dds::SampleInfo info;
  for (std::size_t i = 0; i < kBurst; ++i) {
    const Took took = take(id, &message, info);
    if (took == Took::nothing) return i != 0;
    if (took == Took::sample) guarded([&] { handler(message, origin_of(info)); });
  }
  return true;
}

/// From one key (station) after the other: plain take_next_sample() empties the first key that has any, so
/// that a flood for one station would keep another's samples waiting.
Readers::Took Readers::take(TopicId id, void* object, compat::dds::SampleInfo& info) noexcept {
  try {
    Slot& from = slot(id);
    from.sample.length(1);
    from.info.length(1);
    from.sample[0] = Sample{object, true};
    const auto next = [&] {
      from.sample.length(0);  // the library appends
      from.info.length(0);
      return compat::number_of(from.reader->take_next_instance(from.sample, from.info, 1, from.last));
    };
    auto result = next();
    if (result == compat::kNoData && from.last.isDefined()) {  // past the last key: from the first again
      from.last = compat::rtps::InstanceHandle_t();
      result = next();
    }
    if (result != compat::kOk) return Took::nothing;
    info = from.info[0];
    from.last = info.instance_handle;
    if (!info.valid_data) return Took::dropped;  // an instance was disposed of: not a message
    if (from.sample[0].valid) return Took::sample;
  } catch (...) {  // a sample that the library itself cannot take
  }
  participant_.malformed.fetch_add(1, std::memory_order_relaxed);
  return Took::dropped;
}

/// A handler that throws costs its sample, not the thread.
template <class Call> void Readers::guarded(const Call& call) noexcept {
  try {
    call();
  } catch (...) {
    participant_.malformed.fetch_add(1, std::memory_order_relaxed);
  }
}

void Readers::watch_matches() {
  for (const TopicInfo& info : topics()) {
    auto* reader = slot(info.id).reader;
    if (reader == nullptr) continue;
    if (handlers_.on_incompatible) {
      compat::dds::RequestedIncompatibleQosStatus status;
      static_cast<void>(reader->get_requested_incompatible_qos_status(status));
      if (status.total_count_change > 0) {
        guarded(
            [&] { handlers_.on_incompatible(std::string(info.name), policy_name(status.last_policy_id)); });
      }
    }
    if (handlers_.on_liveliness && info.service == Service::pv) {
      compat::dds::SubscriptionMatchedStatus status;
      static_cast<void>(reader->get_subscription_matched_status(status));
      const int change = status.current_count_change;
      if (change != 0)
        guarded([&] { handlers_.on_liveliness(std::string(info.name), status.current_count, change); });
    }
  }
  if (handlers_.on_incompatible) guarded([&] { writers_.report_incompatible(handlers_.on_incompatible); });
}

}  // namespace stationd::bus

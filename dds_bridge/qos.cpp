#include "dds_bridge/qos.hpp"

#include <algorithm>
#include <memory>

namespace stationd::bus {
namespace {

namespace dds = compat::dds;

constexpr std::int64_t kMs = 1'000'000;
// A participant that says nothing for so long is gone: its endpoints unmatch and block nobody any more.
constexpr std::int64_t kParticipantLease = 3'000 * kMs;
constexpr std::int64_t kParticipantAnnouncement = 750 * kMs;
// What our readers ask for at most; a writer that offers more would not match. Our writers offer 0.
constexpr std::int64_t kAseLatencyBudget = 1 * kMs;
constexpr std::int64_t kPvLatencyBudget = 10 * kMs;
constexpr std::int64_t kHeartbeat = 100 * kMs;  // the library's 3 s would delay each repair so long
constexpr std::int64_t kReplyBlocking = 10 * kMs;
constexpr std::int32_t kInstances = 4096;
constexpr std::int32_t kPreallocated = 4;

/// Table 2's order of transport priorities: highest, high, low, lowest. Announced; Fast DDS does not act on
/// it.
std::uint32_t transport_priority(Service service) {
  switch (service) {
    case Service::ase: return 40;
    case Service::pv: return 30;
    case Service::rnr: return 20;
    case Service::rr: return 10;
    case Service::diagnostic: return 0;
  }
  return 0;
}

/// What both ends of a topic have in common.
template <class Qos> void apply_common(Qos& qos, Service service, const Options& options) {
  const auto request_depth = static_cast<std::int32_t>(options.request_depth);
  const auto event_depth = static_cast<std::int32_t>(options.event_depth);
  auto& limits = qos.resource_limits();
  limits.allocated_samples = kPreallocated;
  switch (service) {
    case Service::pv:
    case Service::diagnostic:
      qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
      qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
      qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
      qos.history().depth = 1;
      limits.max_instances = kInstances;
      limits.max_samples_per_instance = 1;
      limits.max_samples = kInstances;
      break;
    case Service::ase:
      qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
      qos.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
      qos.history().kind = dds::KEEP_ALL_HISTORY_QOS;
      limits.max_instances = 1;
      limits.max_samples_per_instance = event_depth;
      limits.max_samples = event_depth;
      break;
    case Service::rnr:
    case Service::rr:
      // All clients of a station share one key (DEST_STATION, ORDER): with depth 1 they would overwrite each
      // other.
      qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
      qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
      qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
      qos.history().depth = request_depth;
      limits.max_instances = kInstances;
      limits.max_samples_per_instance = request_depth;
      limits.max_samples = kInstances * request_depth;
      break;
  }
  qos.data_sharing().off();
  qos.endpoint().history_memory_policy = compat::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  compat::force_xcdr1(qos);
}

template <class Qos> EndpointQos describe(std::string_view topic, const Qos& qos) {
  EndpointQos is;
  is.topic = topic;
  is.reliable = qos.reliability().kind == dds::RELIABLE_RELIABILITY_QOS;
  is.transient_local = qos.durability().kind == dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  is.keep_all = qos.history().kind == dds::KEEP_ALL_HISTORY_QOS;
  is.depth = is.keep_all ? qos.resource_limits().max_samples : qos.history().depth;
  is.deadline_ns = compat::nanoseconds(qos.deadline().period);
  is.latency_budget_ns = compat::nanoseconds(qos.latency_budget().duration);
  is.lease_ns = compat::nanoseconds(qos.liveliness().lease_duration);
  return is;
}

}  // namespace

dds::DomainParticipantQos participant_qos(const Options& options) {
  dds::DomainParticipantQos qos;
  qos.name(options.name.c_str());
  qos.transport().use_builtin_transports = false;
  auto udp = std::make_shared<compat::transport::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = options.interfaces;
  qos.transport().user_transports.push_back(udp);
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.leaseDuration = compat::duration(kParticipantLease);
  discovery.leaseDuration_announcementperiod = compat::duration(kParticipantAnnouncement);
  compat::without_type_information(qos);
  return qos;
}

dds::DataWriterQos writer_qos(Service service, const Options& options) {
  dds::DataWriterQos qos;
  apply_common(qos, service, options);
  qos.transport_priority().value = transport_priority(service);
  if (service == Service::pv) {
    qos.deadline().period = compat::duration(options.deadline_ns);
    qos.liveliness().kind = dds::AUTOMATIC_LIVELINESS_QOS;
    qos.liveliness().lease_duration = compat::duration(options.lease_ns);
    qos.liveliness().announcement_period = compat::duration(options.lease_ns / 4);
  }
  compat::set_heartbeat(qos, kHeartbeat);
  // An event never waits in write(): what does not fit is kept by the event writer thread and tried again.
  qos.reliability().max_blocking_time = compat::duration(service == Service::ase ? 0 : kReplyBlocking);
  return qos;
}

dds::DataReaderQos reader_qos(Service service, const Options& options) {
  dds::DataReaderQos qos;
  apply_common(qos, service, options);
  // Deadline and lease are not requested: a foreign writer that offers none would not match.
  if (service == Service::ase) qos.latency_budget().duration = compat::duration(kAseLatencyBudget);
  if (service == Service::pv) qos.latency_budget().duration = compat::duration(kPvLatencyBudget);
  return qos;
}

EndpointQos read_back(std::string_view topic, const dds::DataWriter& writer) {
  const dds::DataWriterQos& qos = writer.get_qos();
  EndpointQos is = describe(topic, qos);
  is.writer = true;
  is.transport_priority = qos.transport_priority().value;
  return is;
}

EndpointQos read_back(std::string_view topic, const dds::DataReader& reader) {
  return describe(topic, reader.get_qos());
}

}  // namespace stationd::bus

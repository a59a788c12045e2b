// What a hostile or broken peer writes: raw payloads under our topics; and the QoS of every endpoint of our
// own.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "dds_bridge/cell_types.hpp"
#include "dds_bridge/compat.hpp"
#include "dds_bridge/qos.hpp"
#include "tests/bus_support.hpp"

namespace stationd::bus::test {
namespace {

using Bytes = std::vector<unsigned char>;

/// A type of any name whose samples are the bytes that the test says.
class RawType final : public compat::Type {
 public:
  RawType(const std::string& name, bool keyed) { define(name.c_str(), 200'000, keyed); }
  bool encode(const void* data, compat::rtps::SerializedPayload_t& payload) noexcept override {
    const auto& bytes = *static_cast<const Bytes*>(data);
    std::memcpy(payload.data, bytes.data(), bytes.size());
    payload.length = static_cast<std::uint32_t>(bytes.size());
    payload.encapsulation = CDR_LE;
    return true;
  }
  bool decode(const compat::rtps::SerializedPayload_t&, void*) noexcept override { return true; }
  bool key(const void*, compat::rtps::InstanceHandle_t& handle, bool) noexcept override {
    handle.value[0] = 1;
    return true;
  }
  std::uint32_t encoded_size(const void* data) noexcept override {
    return static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size());
  }
  void* create() override { return new Bytes; }
  void destroy(void* data) noexcept override { delete static_cast<Bytes*>(data); }
};

/// A peer with one writer of raw bytes.
class RawPeer {
 public:
  RawPeer(const std::string& topic_name, const std::string& type_name, bool keyed, Service service) {
    auto* factory = compat::dds::DomainParticipantFactory::get_instance();
    participant_ =
        factory->create_participant(static_cast<std::uint32_t>(domain()), participant_qos(options("raw")));
    REQUIRE(participant_ != nullptr);
    compat::dds::TypeSupport type(new RawType(type_name, keyed));
    compat::without_type_information(type);
    type.register_type(participant_);
    compat::dds::PublisherQos qos;
    qos.partition().push_back(options("").cell.c_str());
    publisher_ = participant_->create_publisher(qos);
    topic_ = participant_->create_topic(topic_name, type_name, compat::dds::TOPIC_QOS_DEFAULT);
    compat::dds::DataWriterQos writer = writer_qos(service, options("raw"));
    writer.reliability().kind = compat::dds::RELIABLE_RELIABILITY_QOS;  // so that each sample arrives
    writer.history().kind = compat::dds::KEEP_ALL_HISTORY_QOS;
    writer.resource_limits().max_samples_per_instance = 1000;
    writer.resource_limits().max_samples = 4'096'000;
    writer_ = publisher_->create_datawriter(topic_, writer);
    REQUIRE(writer_ != nullptr);
  }
  ~RawPeer() {
    publisher_->delete_datawriter(writer_);
    participant_->delete_topic(topic_);
    participant_->delete_publisher(publisher_);
    compat::dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  bool matched() const {
    return eventually([&] {
      compat::dds::PublicationMatchedStatus status;
      writer_->get_publication_matched_status(status);
      return status.current_count > 0;
    });
  }
  void write(const Bytes& bytes) const { CHECK(compat::write(*writer_, &bytes) == compat::kOk); }

 private:
  compat::dds::DomainParticipant* participant_ = nullptr;
  compat::dds::Publisher* publisher_ = nullptr;
  compat::dds::Topic* topic_ = nullptr;
  compat::dds::DataWriter* writer_ = nullptr;
};

Bytes event_bytes(unsigned char error, unsigned char status) {
  return {0, 1, 0, 0, error, 0, 0, 0, status, 0, 0, 0};
}

Bytes request_bytes(std::size_t station_length, unsigned char order) {
  Bytes bytes = {0, 1, 0, 0};
  const auto text = [&](std::size_t length) {
    const std::size_t count = length + 1;
    for (std::size_t shift = 0; shift < 32; shift += 8)
      bytes.push_back(static_cast<unsigned char>(count >> shift));
    bytes.insert(bytes.end(), length, 'r');
    bytes.insert(bytes.end(), 1 + (4 - count % 4) % 4, 0);
  };
  text(station_length);
  text(2);
  bytes.insert(bytes.end(), {order, 0, 0, 0});
  return bytes;
}

TEST_CASE("events when malformed then are counted and the next good one arrives") {
  Inbox<Gse> events;
  Bus bus(options("reader"));
  Handlers handlers;
  handlers.on_gse = [&](const Gse& m, const Origin&) { events.put(m); };
  bus.start(handlers);
  const RawPeer peer("GSE", "ASE_GSE", false, Service::ase);
  REQUIRE(peer.matched());
  peer.write(event_bytes(2, 1));                     // a bool of 2
  peer.write({0, 1, 0, 0, 1, 0, 0});                 // cut off
  peer.write({0, 1, 0, 0});                          // nothing
  peer.write({0, 9, 0, 0, 1, 0, 0, 0, 5, 0, 0, 0});  // unknown encapsulation
  peer.write({9});                                   // not even an encapsulation
  Bytes long_text = event_bytes(1, 7);
  long_text.insert(long_text.end(), {0xFF, 0xFF, 0xFF, 0x7F, 'x'});  // a text of two gigabytes
  peer.write(long_text);
  peer.write(event_bytes(1, 42));
  REQUIRE(events.wait_for(1));
  CHECK(events.all()[0].STATUS == 42);
  CHECK(events.size() == 1);
  CHECK(bus.malformed() == 6);
}

TEST_CASE("keyed requests when malformed then are counted and the next good one arrives [REQ-5]") {
  Inbox<MsgReq> requests;
  Bus bus(options("reader"));
  Handlers handlers;
  handlers.on_request = [&](const MsgReq& m, const Origin&) { requests.put(m); };
  handlers.names = {"rrrrr"};
  bus.start(handlers);
  const RawPeer peer("Msg_Req", "Msg_Req", true, Service::rr);
  REQUIRE(peer.matched());
  peer.write(request_bytes(5, 3));  // unknown enumerator
  peer.write({0, 1, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF});
  peer.write(request_bytes(300, 2));  // keys too long: filtered out, for they are no name of ours
  peer.write(request_bytes(100'000, 2));
  peer.write(request_bytes(5, 2));
  REQUIRE(requests.wait_for(1));
  CHECK(requests.size() == 1);
  CHECK(bus.malformed() == 2);
}

TEST_CASE("keyed samples when their key is too long then are counted and nothing stops") {
  Inbox<MsgReq> requests;
  Bus bus(options("reader"));
  Handlers handlers;
  handlers.on_request = [&](const MsgReq& m, const Origin&) { requests.put(m); };
  bus.start(handlers);
  const RawPeer peer("Msg_Req", "Msg_Req", true, Service::rr);
  REQUIRE(peer.matched());
  peer.write(request_bytes(300, 2));
  peer.write(request_bytes(100'000, 2));
  peer.write(request_bytes(255, 2));
  REQUIRE(requests.wait_for(1));
  CHECK(requests.all()[0].DEST_STATION.size() == 255);
  CHECK(bus.malformed() == 2);
}

TEST_CASE("topic when a peer writes another type under its name then is not matched") {
  Inbox<Gse> events;
  Bus bus(options("reader"));
  Handlers handlers;
  handlers.on_gse = [&](const Gse& m, const Origin&) { events.put(m); };
  bus.start(handlers);
  const RawPeer stranger("GSE", "Something", false, Service::ase);
  const RawPeer peer("GSE", "ASE_GSE", false, Service::ase);
  REQUIRE(peer.matched());
  stranger.write(event_bytes(1, 1));
  peer.write(event_bytes(1, 42));
  REQUIRE(events.wait_for(1));
  CHECK(events.all()[0].STATUS == 42);
  CHECK(events.size() == 1);
}

TEST_CASE("endpoints when read back then have the QoS of Table 2 [PV-1, ASE-2, REQ-1]") {
  Options given = options("all");
  given.deadline_ns = 700'000'000;
  given.lease_ns = 300'000'000;
  Bus bus(given);
  Handlers handlers;
  handlers.on_set = [](const Set&, const Origin&) {};
  handlers.on_end = [](const End&, const Origin&) {};
  handlers.on_status = [](const Status&, const Origin&) {};
  handlers.on_stats = [](const ScanStats&, const Origin&) {};
  handlers.on_gse = [](const Gse&, const Origin&) {};
  handlers.on_start = handlers.on_stop = handlers.on_request = [](const MsgReq&, const Origin&) {};
  handlers.on_reply = [](const MsgRes&, const Origin&, const Origin&) {};
  bus.start(handlers);
  std::vector<std::string> names;
  for (const TopicInfo& info : topics()) names.emplace_back(info.name);
  bus.prepare_writers(names);
  const std::vector<EndpointQos> all = bus.endpoints();
  CHECK(all.size() == 2 * kTopics);
  for (const EndpointQos& is : all) {
    CAPTURE(is.topic);
    CAPTURE(is.writer);
    const Service service = find_topic(is.topic)->service;
    const bool pv = service == Service::pv, ase = service == Service::ase;
    const bool best_effort = pv || service == Service::diagnostic;
    CHECK(is.reliable == !best_effort);
    CHECK(is.transient_local == ase);
    CHECK(is.keep_all == ase);
    CHECK(is.depth == (best_effort ? 1 : ase ? 4096 : 256));
    CHECK(is.deadline_ns == (pv && is.writer ? 700'000'000 : INT64_MAX));
    CHECK(is.lease_ns == (pv && is.writer ? 300'000'000 : INT64_MAX));
    CHECK(is.latency_budget_ns == (is.writer ? 0 : pv ? 10'000'000 : ase ? 1'000'000 : 0));
    const std::uint32_t below = service == Service::rnr ? 20 : service == Service::rr ? 10 : 0;
    const std::uint32_t priority = ase ? 40 : pv ? 30 : below;
    CHECK(is.transport_priority == (is.writer ? priority : 0));
  }
}

TEST_CASE("peer when its QoS does not match then the policy is named on both sides") {
  Inbox<std::string> found;
  Bus bus(options("reader"));
  Handlers handlers;
  handlers.on_gse = [](const Gse&, const Origin&) {};
  handlers.on_incompatible = [&](const std::string& topic, const std::string& policy) {
    found.put(topic + " " + policy);
  };
  bus.start(handlers);
  const RawPeer peer("GSE", "ASE_GSE", false, Service::rnr);  // volatile where durable is asked for
  CHECK(found.wait_for(1));
  CHECK(found.all()[0] == "GSE DURABILITY");
}

}  // namespace
}  // namespace stationd::bus::test

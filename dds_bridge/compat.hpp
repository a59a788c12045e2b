// Compat: the one place that knows which generation of Fast DDS this is built with, 2.9 (Debian 12) or 3.1
// (Debian 13).
// Private to dds_bridge: no header that others include may include it.
// Any plain thread.
#pragma once

#if __has_include(<fastdds/config.hpp>)
#define STATIOND_FASTDDS3 1
#include <fastdds/LibrarySettings.hpp>
#include <fastdds/config.hpp>
#include <fastdds/rtps/common/WriteParams.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/utils/md5.hpp>
#else
#define STATIOND_FASTDDS3 0
#include <fastdds/rtps/common/WriteParams.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/config.h>
#include <fastrtps/utils/md5.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#endif
#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <cstddef>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/publisher/qos/PublisherQos.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/subscriber/qos/SubscriberQos.hpp>
#include <fastdds/dds/topic/ContentFilteredTopic.hpp>
#include <fastdds/dds/topic/IContentFilter.hpp>
#include <fastdds/dds/topic/IContentFilterFactory.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <string>
#include <utility>

namespace stationd::bus::compat {

namespace dds = eprosima::fastdds::dds;
namespace transport = eprosima::fastdds::rtps;
#if STATIOND_FASTDDS3
namespace rtps = eprosima::fastdds::rtps;
using Duration = dds::Duration_t;
using Md5 = eprosima::fastdds::MD5;
using dds::ReturnCode_t;
inline constexpr const char* kVersion = FASTDDS_VERSION_STR;
inline int number_of(ReturnCode_t code) { return code; }
#else
namespace rtps = eprosima::fastrtps::rtps;
using Duration = eprosima::fastrtps::Duration_t;
using Md5 = ::MD5;
using ReturnCode_t = eprosima::fastrtps::types::ReturnCode_t;
inline constexpr const char* kVersion = FASTRTPS_VERSION_STR;
inline int number_of(ReturnCode_t code) { return static_cast<int>(code()); }
#endif

/// Return codes by number: the same in both generations.
inline constexpr int kOk = 0, kError = 1, kTimeout = 10, kNoData = 11;
inline ReturnCode_t return_code(int number) {
#if STATIOND_FASTDDS3
  return number;
#else
  return ReturnCode_t(static_cast<std::uint32_t>(number));
#endif
}

inline Duration duration(std::int64_t ns) {
  constexpr std::int64_t second = 1'000'000'000;
  return Duration(static_cast<std::int32_t>(ns / second), static_cast<std::uint32_t>(ns % second));
}

/// Infinite (which is how DDS says "none") becomes INT64_MAX.
inline std::int64_t nanoseconds(const Duration& value) {
  if (value.seconds == INT32_MAX) return INT64_MAX;
  return std::int64_t{value.seconds} * 1'000'000'000 + std::int64_t{value.nanosec};
}

/// DataWriter::write() returns bool in 2.9 and a code in 3.1 that is 0 when all is well: only these may call
/// it. `data` is not changed: 2.9's signature merely lacks the const.
inline bool write(dds::DataWriter& writer, const void* data, rtps::WriteParams& params) {
#if STATIOND_FASTDDS3
  return writer.write(data, params) == dds::RETCODE_OK;
#else
  return writer.write(const_cast<void*>(data), params);
#endif
}
inline int write(dds::DataWriter& writer, const void* data) {
  return number_of(writer.write(const_cast<void*>(data), dds::InstanceHandle_t()));
}

/// Process-wide, before the first participant: samples between participants of one process take the network
/// path too, so that a write never runs a reader's code in the writer's thread.
inline void set_library_defaults() {
#if STATIOND_FASTDDS3
  eprosima::fastdds::LibrarySettings settings;
  settings.intraprocess_delivery = eprosima::fastdds::INTRAPROCESS_OFF;
  static_cast<void>(dds::DomainParticipantFactory::get_instance()->set_library_settings(settings));
#else
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
#endif
}

/// Type information of ours makes Cyclone DDS 0.10 drop the endpoint: none is sent (3.1: set on the
/// participant).
inline void without_type_information(dds::DomainParticipantQos& qos) {
#if STATIOND_FASTDDS3
  qos.properties().properties().emplace_back("fastdds.type_propagation", "disabled");
#else
  static_cast<void>(qos);
#endif
}
/// The same for 2.9: set on the type, before it is registered.
inline void without_type_information(dds::TypeSupport& type) {
#if STATIOND_FASTDDS3
  static_cast<void>(type);
#else
  type->auto_fill_type_information(false);
  type->auto_fill_type_object(false);
#endif
}

inline void force_xcdr1(dds::DataWriterQos& qos) {
  qos.representation().m_value = {dds::XCDR_DATA_REPRESENTATION};
}
inline void force_xcdr1(dds::DataReaderQos& qos) {
#if STATIOND_FASTDDS3
  qos.representation().m_value = {dds::XCDR_DATA_REPRESENTATION};
#else
  qos.type_consistency().representation.m_value = {dds::XCDR_DATA_REPRESENTATION};
#endif
}

/// How soon a reliable writer tells a reader what it should have, and so how soon a lost sample is repeated.
inline void set_heartbeat(dds::DataWriterQos& qos, std::int64_t ns) {
#if STATIOND_FASTDDS3
  qos.reliable_writer_qos().times.heartbeat_period = duration(ns);
#else
  qos.reliable_writer_qos().times.heartbeatPeriod = duration(ns);
#endif
}

/// TopicDataType with one set of virtual functions for both generations. None of them may throw: they are
/// called from the library's threads, where nobody catches.
class Type : public dds::TopicDataType {
 public:
  virtual bool encode(const void* data, rtps::SerializedPayload_t& payload) noexcept = 0;
  virtual bool decode(const rtps::SerializedPayload_t& payload, void* data) noexcept = 0;
  virtual bool key(const void* data, rtps::InstanceHandle_t& handle, bool force_md5) noexcept = 0;
  virtual std::uint32_t encoded_size(const void* data) noexcept = 0;
  virtual void* create() = 0;
  virtual void destroy(void* data) noexcept = 0;

 protected:
  void define(const char* name, std::uint32_t usual_size, bool keyed) {
#if STATIOND_FASTDDS3
    set_name(name);
    max_serialized_type_size = usual_size;
    is_compute_key_provided = keyed;
#else
    setName(name);
    m_typeSize = usual_size;
    m_isGetKeyDefined = keyed;
#endif
  }

 private:
#if STATIOND_FASTDDS3
  bool serialize(const void* const data, rtps::SerializedPayload_t& payload,
                 dds::DataRepresentationId_t) final {
    return encode(data, payload);
  }
  bool deserialize(rtps::SerializedPayload_t& payload, void* data) final { return decode(payload, data); }
  std::uint32_t calculate_serialized_size(const void* const data, dds::DataRepresentationId_t) final {
    return encoded_size(data);
  }
  bool compute_key(const void* const data, rtps::InstanceHandle_t& handle, bool force_md5) final {
    return key(data, handle, force_md5);
  }
  bool compute_key(rtps::SerializedPayload_t& payload, rtps::InstanceHandle_t& handle, bool force_md5) final {
    void* data = create();
    const bool ok = decode(payload, data) && key(data, handle, force_md5);
    destroy(data);
    return ok;
  }
  void* create_data() final { return create(); }
  void delete_data(void* data) final { destroy(data); }
  bool is_bounded() const final { return false; }
  bool is_plain(dds::DataRepresentationId_t) const final { return false; }
#else
  bool serialize(void* data, rtps::SerializedPayload_t* payload) final { return encode(data, *payload); }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) final { return decode(*payload, data); }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) final {
    const std::uint32_t size = encoded_size(data);
    return [size] { return size; };
  }
  bool getKey(void* data, rtps::InstanceHandle_t* handle, bool force_md5) final {
    return key(data, *handle, force_md5);
  }
  void* createData() final { return create(); }
  void deleteData(void* data) final { destroy(data); }
#endif
};

// The library's interfaces lack a virtual destructor; it deletes filters through their factory only.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wnon-virtual-dtor"
class ContentFilter : public dds::IContentFilter {
 public:
  virtual ~ContentFilter() = default;
};
class ContentFilterFactory : public dds::IContentFilterFactory {
 public:
  virtual ~ContentFilterFactory() = default;
};
#pragma GCC diagnostic pop

}  // namespace stationd::bus::compat

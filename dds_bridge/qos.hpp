// QoS: the endpoints' quality of service, by the paper's Table 2 as it can be met with foreign peers.
// Private to dds_bridge; pure functions of the options.
// Any plain thread.
#pragma once

#include "dds_bridge/bus.hpp"
#include "dds_bridge/cell_types.hpp"
#include "dds_bridge/compat.hpp"

namespace stationd::bus {

compat::dds::DomainParticipantQos participant_qos(const Options& options);
compat::dds::DataWriterQos writer_qos(Service service, const Options& options);
compat::dds::DataReaderQos reader_qos(Service service, const Options& options);

/// What an endpoint really has, read back from it.
EndpointQos read_back(std::string_view topic, const compat::dds::DataWriter& writer);
EndpointQos read_back(std::string_view topic, const compat::dds::DataReader& reader);

}  // namespace stationd::bus

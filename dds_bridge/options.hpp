// Plain options of the bus: what the configuration says about DDS.
// Owned by the configuration; copied into the bus at set-up.
// Set-up only.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace stationd::bus {

struct Options {
  int domain = 0;                 ///< 0..99 (higher ports fall into the ephemeral range)
  std::string cell = "assembly";  ///< DDS partition
  std::vector<std::string> interfaces = {"127.0.0.1"};  ///< IPv4 addresses to bind to; empty: all
  /// participant name: the controller, "supervisor", "stationctl"
  std::string name;
  std::int64_t lease_ns = 500'000'000;     ///< liveliness lease of PV writers
  std::int64_t deadline_ns = 500'000'000;  ///< offered by PV writers: maximum process time
  std::size_t max_body_bytes = 8192;       ///< of requests and replies
  std::size_t request_depth = 256;         ///< keep-last depth of RNR and RR endpoints
  std::size_t event_depth = 4096;          ///< bound of an event writer's and reader's KEEP_ALL
};

}  // namespace stationd::bus

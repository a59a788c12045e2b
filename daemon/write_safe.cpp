#include "daemon/write_safe.hpp"

#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "daemon/device_points.hpp"
#include "daemon/exit_status.hpp"
#include "daemon/state_lock.hpp"
#include "io/device.hpp"
#include "io/modbus/modbus_backend.hpp"
#include "scan/rt_thread.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kTryForNs = 2'000'000'000;
constexpr timespec kPause{0, 50'000'000};

/// Outputs alone: what cannot be read must not keep them from being written.
std::vector<io::Point> outputs_of(const config::Configuration& configuration, const std::string& device) {
  std::vector<io::Point> points = DevicePoints(configuration, device).all();
  std::erase_if(points, [](const io::Point& p) { return p.direction == io::Direction::input; });
  return points;
}

io::ExchangeResult write_safe_to(io::DeviceOptions device, const std::vector<io::Point>& points) {
  device.heartbeat_period_ns = 0;
  io::ModbusBackend backend(device, points);
  const std::int64_t until_ns = monotonic_ns() + kTryForNs;
  while (true) {
    const io::ExchangeResult result = io::write_safe(backend, points, monotonic_ns());
    if (result.status == io::ExchangeStatus::ok || monotonic_ns() > until_ns) return result;
    nanosleep(&kPause, nullptr);
  }
}

}  // namespace

int write_safe_outputs(const config::Configuration& configuration) {
  const char* ended = std::getenv("EXIT_STATUS");  // of the service, as systemd tells ExecStopPost=
  if (ended != nullptr && std::string_view(ended) == std::to_string(kExitUnavailable)) {
    std::printf("nothing written: the daemon gave way to another one, or had no bus, and drove nothing\n");
    return kExitOk;
  }
  const StateLock lock(configuration.state_dir, configuration.name);
  if (lock.held_by_other()) {
    std::fprintf(stderr,
                 "stationd: nothing written: controller \"%s\" is running (%s is held); stop it first\n",
                 configuration.name.c_str(), lock.path().c_str());
    return kExitUnavailable;
  }
  int status = kExitOk;
  for (const io::DeviceOptions& device : configuration.devices) {
    if (device.kind != io::DeviceKind::modbus) continue;
    const io::ExchangeResult result = write_safe_to(device, outputs_of(configuration, device.name));
    if (result.status == io::ExchangeStatus::ok) {
      std::printf("%s: safe values written\n", device.name.c_str());
      continue;
    }
    std::fprintf(stderr, "%s: safe values NOT written: %s\n", device.name.c_str(),
                 io::describe(result).c_str());
    status = kExitFailure;
  }
  return status;
}

}  // namespace stationd

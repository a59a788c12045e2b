#include "daemon/write_safe.hpp"

#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "daemon/device_points.hpp"
#include "daemon/exit_status.hpp"
#include "daemon/state_lock.hpp"
#include "io/device.hpp"
#include "io/modbus/modbus_backend.hpp"
#include "scan/rt_thread.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kTryForNs = 2'000'000'000;
constexpr std::int64_t kLongestWaitNs = 1'000'000'000;  // all has to fit into the unit's TimeoutStopSec=
constexpr timespec kPause{0, 50'000'000};

/// Outputs alone: what cannot be read must not keep them from being written.
std::vector<io::Point> outputs_of(const config::Configuration& configuration, const std::string& device) {
  std::vector<io::Point> points = DevicePoints(configuration, device).all();
  std::erase_if(points, [](const io::Point& p) { return p.direction == io::Direction::input; });
  return points;
}

/// Why not; empty: written. As text, since a result's detail is the backend's and ends with it.
std::string write_safe_to(io::DeviceOptions device, const std::vector<io::Point>& points) {
  device.heartbeat_period_ns = 0;
  device.timeout_ns = std::min(device.timeout_ns, kLongestWaitNs);
  io::ModbusBackend backend(device, points);
  const std::int64_t until_ns = monotonic_ns() + kTryForNs;
  while (true) {
    const io::ExchangeResult result = io::write_safe(backend, points, monotonic_ns());
    if (result.status == io::ExchangeStatus::ok) return {};
    if (monotonic_ns() > until_ns) return io::describe(result);
    nanosleep(&kPause, nullptr);
  }
}

struct Attempt {
  const io::DeviceOptions* device;
  std::vector<io::Point> outputs;
  std::string problem;
};

/// All at once: a device that is not there must not cost the others their turn before the service manager's
/// patience ends.
void write_all(std::vector<Attempt>& attempts) {
  std::vector<std::thread> threads;
  for (Attempt& attempt : attempts) {
    const auto write = [&attempt] { attempt.problem = write_safe_to(*attempt.device, attempt.outputs); };
    try {
      threads.emplace_back(write);
    } catch (const std::system_error&) {  // no thread to be had
      write();
    }
  }
  for (std::thread& thread : threads) thread.join();
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
  std::vector<Attempt> attempts;
  for (const io::DeviceOptions& device : configuration.devices)
    if (device.kind == io::DeviceKind::modbus)
      attempts.push_back({&device, outputs_of(configuration, device.name), {}});
  write_all(attempts);
  int status = kExitOk;
  for (const Attempt& attempt : attempts) {
    const char* name = attempt.device->name.c_str();
    if (attempt.problem.empty()) {
      std::printf("%s: safe values written\n", name);
      continue;
    }
    std::fprintf(stderr, "%s: safe values NOT written: %s\n", name, attempt.problem.c_str());
    status = kExitFailure;
  }
  return status;
}

}  // namespace stationd

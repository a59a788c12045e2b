#include "daemon/write_safe.hpp"

#include <cstdio>

#include "daemon/device_points.hpp"
#include "daemon/exit_status.hpp"
#include "io/device.hpp"
#include "io/modbus/modbus_backend.hpp"
#include "scan/rt_thread.hpp"

namespace stationd {

int write_safe_outputs(const config::Configuration& configuration) {
  int status = kExitOk;
  for (const io::DeviceOptions& device : configuration.devices) {
    if (device.kind != io::DeviceKind::modbus) continue;
    const DevicePoints points(configuration, device.name);
    io::ModbusBackend backend(device, points.all());
    const io::ExchangeResult result = io::write_safe(backend, points.all(), monotonic_ns());
    backend.close();
    const bool ok = result.status == io::ExchangeStatus::ok;
    if (ok)
      std::printf("%s: safe values written\n", device.name.c_str());
    else
      std::fprintf(stderr, "%s: safe values NOT written: %s\n", device.name.c_str(),
                   io::describe(result).c_str());
    if (!ok) status = kExitFailure;
  }
  return status;
}

}  // namespace stationd

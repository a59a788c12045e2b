// Backend: how a device thread exchanges values with one field device; the seam with modbus, simulated,
// null, fake.
// Owned by its device thread.
// The device thread only; may block, up to the device's time-out.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "scan/value.hpp"

namespace stationd::io {

/// An output as it is to stand at the device. `write == false`: leave it as the device has it (safe value
/// `hold`).
struct OutputValue {
  Slot value = 0;
  bool write = true;
};

enum class ExchangeStatus : std::uint8_t {
  ok,
  disconnected,  ///< no connection (refused, unreachable, lost, within back-off)
  timeout,       ///< the device did not answer in time; what was written counts as unknown
  protocol,      ///< an answer that breaks the protocol: wrong unit, count, garbage
  exception      ///< the device refused (Modbus exception); the connection stays
};

struct ExchangeResult {
  ExchangeStatus status = ExchangeStatus::ok;
  const char* detail = "";  ///< static text for the log: "connect", "read di 0..19", ...
  int code = 0;             ///< errno or Modbus exception code
};

class Backend {
 public:
  virtual ~Backend() = default;

  /// Writes the outputs and reads all inputs, in the order of the points that the backend was made with
  /// (inputs and
  /// outputs counted apart). `inputs` is only meaningful when the status is ok. Blocks at most about the
  /// device's time-out per
  /// request; reconnects by itself with back-off (then returns `disconnected` at once). `now_ns`:
  /// CLOCK_MONOTONIC.
  virtual ExchangeResult exchange(std::span<const OutputValue> outputs, std::span<Slot> inputs,
                                  std::int64_t now_ns) = 0;

  /// Gives up the connection; the next exchange makes a new one at once, without back-off.
  virtual void close() noexcept = 0;

  /// Any thread: the end has come. An exchange that blocks now fails at once, and none waits longer than some
  /// 0.2 s for a connection or an answer any more, whatever the device's time-out.
  virtual void interrupt() noexcept {}
};

}  // namespace stationd::io

// ModbusBackend: exchanges a device's points over Modbus/TCP: all outputs written, then all inputs read.
// Owned by its device thread; owns the connection.
// The device thread only; blocks at most about the time-out when the device fails.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "io/backend.hpp"
#include "io/modbus/backoff.hpp"
#include "io/modbus/connection.hpp"
#include "io/modbus/plan.hpp"
#include "io/options.hpp"

namespace stationd::io {

class ModbusBackend final : public Backend {
 public:
  ModbusBackend(DeviceOptions options, const std::vector<Point>& points);

  /// A failed request ends the round: at most one time-out, and what was written before it counts as unknown.
  ExchangeResult exchange(std::span<const OutputValue> outputs, std::span<Slot> inputs,
                          std::int64_t now_ns) override;
  void close() noexcept override {
    connection_.close();
    backoff_.forget();
  }
  void interrupt() noexcept override { connection_.interrupt(); }

 private:
  ExchangeResult exchange_all(std::span<const OutputValue> outputs, std::span<Slot> inputs,
                              std::int64_t now_ns);
  ExchangeResult write(const modbus::Request& request, std::span<const OutputValue> outputs);
  ExchangeResult read(const modbus::Request& request, std::span<Slot> inputs);
  ExchangeResult beat(std::int64_t now_ns);
  ExchangeResult transact(const modbus::Adu& adu, const modbus::Request& request);
  modbus::Address next_address() noexcept;

  const DeviceOptions options_;
  const std::vector<modbus::Request> reads_, writes_;
  modbus::Connection connection_;
  modbus::Backoff backoff_;
  std::uint16_t transaction_ = 0;
  std::uint16_t beats_ = 0;
  std::int64_t next_beat_ns_ = INT64_MIN;
};

}  // namespace stationd::io

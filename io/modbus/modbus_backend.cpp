#include "io/modbus/modbus_backend.hpp"

#include <functional>

namespace stationd::io {

using modbus::Adu;
using modbus::Item;
using modbus::Request;

ModbusBackend::ModbusBackend(DeviceOptions options, const std::vector<Point>& points)
    : options_(std::move(options)), reads_(modbus::plan_reads(points)), writes_(modbus::plan_writes(points)),
      connection_(options_.host, options_.port, options_.timeout_ns),
      backoff_(std::hash<std::string>{}(options_.name)) {}

modbus::Address ModbusBackend::next_address() noexcept {
  return {++transaction_, static_cast<std::uint8_t>(options_.unit)};
}

ExchangeResult ModbusBackend::exchange(std::span<const OutputValue> outputs, std::span<Slot> inputs,
                                       std::int64_t now_ns) {
  if (!connection_.is_open()) {
    if (!backoff_.may_try(now_ns))
      return {ExchangeStatus::disconnected, "waiting before the next attempt", 0};
    if (const ExchangeResult opened = connection_.open(); opened.status != ExchangeStatus::ok) {
      backoff_.failed(now_ns);
      return opened;
    }
  }
  const ExchangeResult result = exchange_all(outputs, inputs, now_ns);
  if (result.status == ExchangeStatus::ok) backoff_.succeeded();
  if (!connection_.is_open()) backoff_.failed(now_ns);
  return result;
}

ExchangeResult ModbusBackend::exchange_all(std::span<const OutputValue> outputs, std::span<Slot> inputs,
                                           std::int64_t now_ns) {
  // A request that the device refuses must not keep the others, which may be safe values, from it.
  ExchangeResult refused;
  for (const Request& request : writes_) {
    const ExchangeResult result = write(request, outputs);
    if (result.status == ExchangeStatus::exception)
      refused = refused.status == ExchangeStatus::ok ? result : refused;
    else if (result.status != ExchangeStatus::ok)
      return result;
  }
  if (refused.status != ExchangeStatus::ok) return refused;
  if (const ExchangeResult result = beat(now_ns); result.status != ExchangeStatus::ok) return result;
  for (const Request& request : reads_)
    if (const ExchangeResult result = read(request, inputs); result.status != ExchangeStatus::ok)
      return result;
  return {};
}

ExchangeResult ModbusBackend::transact(const Adu& adu, const Request& request) {
  ExchangeResult result = connection_.transact(adu);
  if (result.status != ExchangeStatus::ok && result.status != ExchangeStatus::protocol)
    result.detail = request.label.c_str();
  return result;
}

ExchangeResult ModbusBackend::write(const Request& request, std::span<const OutputValue> outputs) {
  for (modbus::Stretch s = modbus::next_stretch(request, 0, outputs); s.begin != s.end;
       s = modbus::next_stretch(request, s.end, outputs)) {
    const std::uint32_t first = request.items[s.begin].offset;
    const Item& last = request.items[s.end - 1];
    Adu adu = modbus::write_request(next_address(), request.table,
                                    static_cast<std::uint16_t>(request.first + first),
                                    last.offset + last.width - first);
    for (std::size_t i = s.begin; i < s.end; ++i) {
      const Item& item = request.items[i];
      const Slot value = outputs[item.point].value;
      if (is_bits(request.table))
        modbus::put_bit(adu, item.offset - first, value != 0);
      else
        modbus::put_value(adu, item.offset - first, item.type, value);
    }
    if (const ExchangeResult result = transact(adu, request); result.status != ExchangeStatus::ok)
      return result;
  }
  return {};
}

ExchangeResult ModbusBackend::read(const Request& request, std::span<Slot> inputs) {
  const Adu adu = modbus::read_request(next_address(), request.table, request.first, request.count);
  const ExchangeResult result = transact(adu, request);
  if (result.status != ExchangeStatus::ok) return result;
  for (const Item& item : request.items)
    inputs[item.point] = is_bits(request.table)
                             ? static_cast<Slot>(modbus::bit_at(connection_.reply(), item.offset))
                             : modbus::value_at(connection_.reply(), item.offset, item.type);
  return result;
}

ExchangeResult ModbusBackend::beat(std::int64_t now_ns) {
  if (options_.heartbeat_period_ns == 0 || now_ns < next_beat_ns_) return {};
  const Adu adu = modbus::write_register_request(next_address(), options_.heartbeat_register, ++beats_);
  ExchangeResult result = connection_.transact(adu);
  if (result.status == ExchangeStatus::ok)
    next_beat_ns_ = now_ns + options_.heartbeat_period_ns;
  else if (result.status != ExchangeStatus::protocol)
    result.detail = "write heartbeat";
  return result;
}

}  // namespace stationd::io

#include "scan/links.hpp"

#include "scan/codes.hpp"

namespace stationd {

void StationPort::announce(std::uint32_t code, Severity severity, std::int64_t detail,
                           std::int64_t utc_ns) noexcept {
  Event event;
  event.seq = event_seq.fetch_add(1, std::memory_order_relaxed) + 1;
  event.code = code;
  event.severity = severity;
  event.active = true;
  event.utc_ns = utc_ns;
  event.detail = detail;
  runtime_events.push(event);
}

void StationPort::hang(std::int64_t idle_ns, std::int64_t utc_ns) noexcept {
  hung.store(true, std::memory_order_release);
  permit.store(false, std::memory_order_release);
  announce(code::watchdog, Severity::fault, idle_ns, utc_ns);
}

}  // namespace stationd

#include "scan/links.hpp"

#include "scan/codes.hpp"

namespace stationd {

void StationPort::hang(std::int64_t idle_ns, std::int64_t utc_ns) noexcept {
  hung.store(true, std::memory_order_release);
  permit.store(false, std::memory_order_release);
  Event event;
  event.seq = event_seq.fetch_add(1, std::memory_order_relaxed) + 1;
  event.code = code::watchdog;
  event.severity = Severity::fault;
  event.active = true;
  event.utc_ns = utc_ns;
  event.detail = idle_ns;
  watchdog_events.push(event);
}

}  // namespace stationd

#include "dds_bridge/throttle.hpp"

namespace stationd::bus {

void Throttle::say(const std::string& kind, int severity, const std::string& text, std::int64_t now_ns) {
  {
    const std::lock_guard lock(mutex_);
    const auto [place, fresh] = kinds_.try_emplace(kind);
    Held& held = place->second;
    if (!fresh && now_ns - held.said_ns < kPeriod) {
      ++held.count;
      held.severity = severity;
      held.text = text;
      return;
    }
    held.said_ns = now_ns;
  }
  if (sink_) sink_(severity, text);
}

void Throttle::flush(std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  for (auto& [kind, held] : kinds_) {
    if (held.count == 0 || now_ns - held.said_ns < kPeriod) continue;
    const std::string times = held.count == 1 ? "" : " (" + std::to_string(held.count) + " such)";
    if (sink_) sink_(held.severity, held.text + times);
    held.count = 0;
    held.said_ns = now_ns;
  }
}

}  // namespace stationd::bus

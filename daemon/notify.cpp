#include "daemon/notify.hpp"

#include <systemd/sd-daemon.h>

namespace stationd {

SystemdNotify::SystemdNotify() {
  std::uint64_t limit_us = 0;
  if (sd_watchdog_enabled(0, &limit_us) > 0) watchdog_limit_ns_ = static_cast<std::int64_t>(limit_us) * 1000;
}

void SystemdNotify::ready(const std::string& status) { sd_notify(0, ("READY=1\nSTATUS=" + status).c_str()); }
void SystemdNotify::status(const std::string& text) { sd_notify(0, ("STATUS=" + text).c_str()); }
void SystemdNotify::watchdog() { sd_notify(0, "WATCHDOG=1"); }
void SystemdNotify::reloading() { sd_notify(0, "RELOADING=1"); }
void SystemdNotify::stopping() { sd_notify(0, "STOPPING=1"); }

}  // namespace stationd

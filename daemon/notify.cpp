#include "daemon/notify.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace stationd {
namespace {

constexpr int kPatienceMs = 1000;  // for what must not be lost

}  // namespace

SystemdNotify::SystemdNotify() {
  std::uint64_t limit_us = 0;
  if (sd_watchdog_enabled(0, &limit_us) > 0) watchdog_limit_ns_ = static_cast<std::int64_t>(limit_us) * 1000;
  const char* path = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  if (path == nullptr || std::strlen(path) >= sizeof address.sun_path) return;
  address.sun_family = AF_UNIX;
  std::strcpy(address.sun_path, path);
  if (*path == '@') address.sun_path[0] = '\0';  // abstract name space
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(path));
  socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ >= 0 && connect(socket_, reinterpret_cast<const sockaddr*>(&address), length) != 0) {
    close(socket_);
    socket_ = -1;
  }
}

SystemdNotify::~SystemdNotify() {
  if (socket_ >= 0) close(socket_);
}

/// sd_notify() would block the main thread for as long as nobody reads the socket.
void SystemdNotify::send(const std::string& text, int patience_ms) const {
  if (socket_ < 0) return;
  if (::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) >= 0 || patience_ms == 0) return;
  pollfd writable{socket_, POLLOUT, 0};
  poll(&writable, 1, patience_ms);
  static_cast<void>(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL));
}

void SystemdNotify::ready(const std::string& status) { send("READY=1\nSTATUS=" + status, kPatienceMs); }
void SystemdNotify::status(const std::string& text) { send("STATUS=" + text, 0); }
void SystemdNotify::watchdog() { send("WATCHDOG=1", 0); }
void SystemdNotify::reloading() { send("RELOADING=1", kPatienceMs); }
void SystemdNotify::stopping() { send("STOPPING=1", kPatienceMs); }

}  // namespace stationd

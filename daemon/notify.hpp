// Notify: the service manager's notification socket (sd_notify).
// Owned by main().
// The main thread only.
#pragma once

#include <cstdint>
#include <string>

namespace stationd {

/// Seam: what a service manager is told.
class Notify {
 public:
  virtual ~Notify() = default;
  virtual void ready(const std::string& status) = 0;
  virtual void status(const std::string& text) = 0;
  virtual void watchdog() = 0;
  virtual void reloading() = 0;
  virtual void stopping() = 0;
  /// What the service manager's watchdog allows between two calls of watchdog(); 0: it does not watch.
  virtual std::int64_t watchdog_limit_ns() const = 0;
};

/// Sends to $NOTIFY_SOCKET; without one every call does nothing. Never blocks for long when nobody reads it:
/// a STATUS or
/// WATCHDOG that does not fit is dropped, the others wait a second at most.
class SystemdNotify final : public Notify {
 public:
  SystemdNotify();
  ~SystemdNotify() override;
  SystemdNotify(const SystemdNotify&) = delete;
  SystemdNotify& operator=(const SystemdNotify&) = delete;
  void ready(const std::string& status) override;
  void status(const std::string& text) override;
  void watchdog() override;
  void reloading() override;
  void stopping() override;
  std::int64_t watchdog_limit_ns() const override { return watchdog_limit_ns_; }

 private:
  void send(const std::string& text, int patience_ms) const;

  int socket_ = -1;
  std::int64_t watchdog_limit_ns_ = 0;
};

}  // namespace stationd

// Connection: one TCP connection to a Modbus device, and one request with its reply over it.
// Owned by the device's backend.
// The device thread, but for interrupt(); blocks at most about the time-out per call.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>

#include "io/backend.hpp"
#include "io/modbus/adu.hpp"

// NOLINTNEXTLINE(bugprone-reserved-identifier): the name is libmodbus's; its header stays in .cpp files
struct _modbus;

namespace stationd::io::modbus {

class Connection {
 public:
  /// `host`: an IPv4 literal. `timeout_ns`: limit of connecting, and of each request with its reply.
  Connection(std::string host, std::uint16_t port, std::int64_t timeout_ns);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool is_open() const noexcept { return context_ != nullptr; }
  ExchangeResult open() noexcept;
  void close() noexcept;
  /// Any thread: a call that blocks now fails at once, and no later one waits longer than kLastWaitNs.
  void interrupt() noexcept;
  static constexpr std::int64_t kLastWaitNs = 200'000'000;

  /// Sends the request, waits for the reply and judges it. After all but ok and an exception the connection
  /// is closed: what comes late would be taken for the answer to the next request.
  ExchangeResult transact(const Adu& request) noexcept;
  /// The reply of the last transact() that was ok.
  std::span<const std::uint8_t> reply() const noexcept { return {reply_.data(), reply_size_}; }

 private:
  ExchangeResult connect_socket(int socket) const noexcept;
  void use(int socket) noexcept;
  ExchangeResult receive(const Adu& request) noexcept;

  std::string host_;
  std::uint16_t port_;
  std::atomic<std::int64_t> timeout_ns_;
  std::mutex mutex_;  // for socket_: what is closed must not be shut down by its number
  int socket_ = -1;
  _modbus* context_ = nullptr;  // libmodbus's; owns the socket
  std::array<std::uint8_t, kMaxAduBytes> reply_{};
  std::size_t reply_size_ = 0;
};

}  // namespace stationd::io::modbus

// ModbusServer: serves a plant's four units over Modbus/TCP to several clients at once.
// Owned by plantsim (or a test).
// One thread: the one that steps the plant; never blocks longer than asked.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "io/plant/modbus_pdu.hpp"

namespace stationd::plant {

class ModbusServer {
 public:
  static constexpr std::size_t kClientsMax = 64;

  /// Listens on `address` (IPv4 literal) and `port` (0: the kernel picks). Throws std::system_error with the
  /// system's reason ("Address already in use"), std::invalid_argument for an address that is none.
  ModbusServer(const std::string& address, std::uint16_t port);
  ~ModbusServer();
  ModbusServer(const ModbusServer&) = delete;
  ModbusServer& operator=(const ModbusServer&) = delete;

  std::uint16_t port() const noexcept { return port_; }
  std::size_t clients() const noexcept { return clients_.size(); }
  /// Connections closed because what came was not Modbus/TCP, or because there were too many.
  std::uint64_t refused() const noexcept { return refused_; }

  /// Waits at most `timeout_ms` for something to do and does it; a signal ends the wait. `before_requests` is
  /// called once before any request is carried out: bring the plant up to date there.
  void poll(Plant& plant, int timeout_ms, const std::function<void()>& before_requests);

 private:
  struct Client {
    int fd = -1;
    std::size_t received = 0;
    std::size_t to_send = 0;  ///< what the socket did not take yet; nothing is read until it did
    std::size_t sent = 0;
    std::array<std::uint8_t, kAduMax> in{};
    Reply out{};
  };

  void accept_clients();
  bool serve(Client& client, Plant& plant);
  bool receive(Client& client);
  bool answer_all(Client& client, Plant& plant);
  bool send(Client& client);

  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::uint64_t refused_ = 0;
  std::vector<Client> clients_;
};

}  // namespace stationd::plant

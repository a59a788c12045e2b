#include "io/plant/modbus_server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

namespace stationd::plant {

namespace {

/// The sockets API passes every kind of address as sockaddr*.
sockaddr* generic(sockaddr_in& address) noexcept { return reinterpret_cast<sockaddr*>(&address); }

void set_option(int fd, int level, int option, int value) noexcept {
  static_cast<void>(::setsockopt(fd, level, option, &value, sizeof value));
}

/// A client whose machine vanished frees its place after about half a minute.
void watch_connection(int fd) noexcept {
  set_option(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(fd, IPPROTO_TCP, TCP_KEEPIDLE, 10);
  set_option(fd, IPPROTO_TCP, TCP_KEEPINTVL, 5);
  set_option(fd, IPPROTO_TCP, TCP_KEEPCNT, 3);
}

bool would_block(int error) noexcept { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

}  // namespace

ModbusServer::ModbusServer(const std::string& address, std::uint16_t port) {
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(port);
  if (::inet_pton(AF_INET, address.c_str(), &where.sin_addr) != 1) {
    throw std::invalid_argument("\"" + address + "\" is not an IPv4 address such as 127.0.0.1");
  }
  clients_.reserve(kClientsMax);
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (listener_ < 0) throw std::system_error(errno, std::generic_category());
  set_option(listener_, SOL_SOCKET, SO_REUSEADDR, 1);
  socklen_t size = sizeof where;
  if (::bind(listener_, generic(where), size) != 0 || ::listen(listener_, SOMAXCONN) != 0 ||
      ::getsockname(listener_, generic(where), &size) != 0) {
    const int error = errno;
    ::close(listener_);
    throw std::system_error(error, std::generic_category());
  }
  port_ = ntohs(where.sin_port);
}

ModbusServer::~ModbusServer() {
  for (const Client& client : clients_) ::close(client.fd);
  ::close(listener_);
}

void ModbusServer::poll(Plant& plant, int timeout_ms, const std::function<void()>& before_requests) {
  std::array<pollfd, kClientsMax + 1> waits{};
  const std::size_t count = clients_.size();
  for (std::size_t i = 0; i < count; ++i) {
    waits[i] = {clients_[i].fd, static_cast<short>(clients_[i].to_send != 0 ? POLLOUT : POLLIN), 0};
  }
  waits[count] = {listener_, POLLIN, 0};
  const int ready = ::poll(waits.data(), count + 1, timeout_ms);
  before_requests();
  if (ready <= 0) return;
  for (std::size_t i = 0; i < count; ++i) {
    if (waits[i].revents == 0 || serve(clients_[i], plant)) continue;
    ::close(clients_[i].fd);
    clients_[i].fd = -1;
  }
  std::erase_if(clients_, [](const Client& client) { return client.fd < 0; });
  if (waits[count].revents != 0) accept_clients();
}

void ModbusServer::accept_clients() {
  for (;;) {
    const int fd = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0) return;
    if (clients_.size() == kClientsMax) {
      ++refused_;
      ::close(fd);
      continue;
    }
    watch_connection(fd);
    clients_.emplace_back().fd = fd;
  }
}

/// False: the connection is to be closed.
bool ModbusServer::serve(Client& client, Plant& plant) {
  if (client.to_send != 0 && !send(client)) return false;
  if (client.to_send != 0) return true;
  // Requests that came in one piece with the last one are answered before more is read.
  if (!answer_all(client, plant)) return false;
  return client.to_send != 0 || (receive(client) && answer_all(client, plant));
}

bool ModbusServer::receive(Client& client) {
  const ssize_t got =
      ::recv(client.fd, client.in.data() + client.received, client.in.size() - client.received, 0);
  if (got < 0) return would_block(errno);
  client.received += static_cast<std::size_t>(got);
  return got != 0;
}

bool ModbusServer::answer_all(Client& client, Plant& plant) {
  while (client.to_send == 0) {
    const Frame frame = first_frame({client.in.data(), client.received});
    if (frame.status == FrameStatus::incomplete) return true;
    if (frame.status == FrameStatus::garbage) {
      ++refused_;
      return false;
    }
    client.to_send = answer(plant, {client.in.data(), frame.length}, client.out);
    client.sent = 0;
    client.received -= frame.length;
    std::memmove(client.in.data(), client.in.data() + frame.length, client.received);
    if (!send(client)) return false;
  }
  return true;
}

bool ModbusServer::send(Client& client) {
  const ssize_t put =
      ::send(client.fd, client.out.data() + client.sent, client.to_send - client.sent, MSG_NOSIGNAL);
  if (put < 0) return would_block(errno);
  client.sent += static_cast<std::size_t>(put);
  if (client.sent == client.to_send) client.to_send = 0;
  return true;
}

}  // namespace stationd::plant

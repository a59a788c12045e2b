#include "io/modbus/connection.hpp"

#include <arpa/inet.h>
#include <modbus/modbus.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace stationd::io::modbus {
namespace {

static_assert(kMaxAduBytes >= MODBUS_TCP_MAX_ADU_LENGTH, "libmodbus writes replies of that length");

constexpr std::int64_t kNsPerMs = 1'000'000, kNsPerS = 1'000'000'000;
constexpr int kKeepIdleS = 5, kKeepIntervalS = 2, kKeepCount = 3;
constexpr unsigned kUnackedMs = 3'000;

int whole_ms(std::int64_t ns) noexcept { return static_cast<int>(std::max<std::int64_t>(1, ns / kNsPerMs)); }

void set_option(int socket, int level, int option, int value) noexcept {
  // Refused options make a lost peer slower to notice; the request's own time-out still holds.
  static_cast<void>(setsockopt(socket, level, option, &value, sizeof value));
}

void set_options(int socket) noexcept {
  set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(socket, IPPROTO_TCP, TCP_KEEPIDLE, kKeepIdleS);
  set_option(socket, IPPROTO_TCP, TCP_KEEPINTVL, kKeepIntervalS);
  set_option(socket, IPPROTO_TCP, TCP_KEEPCNT, kKeepCount);
  set_option(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, static_cast<int>(kUnackedMs));
}

bool is_timeout(int error) noexcept { return error == ETIMEDOUT || error == EAGAIN || error == EINPROGRESS; }

}  // namespace

Connection::Connection(std::string host, std::uint16_t port, std::int64_t timeout_ns)
    : host_(std::move(host)), port_(port), timeout_ns_(timeout_ns) {}

Connection::~Connection() { close(); }

void Connection::close() noexcept {
  if (context_ == nullptr) return;
  use(-1);
  modbus_close(context_);
  modbus_free(context_);
  context_ = nullptr;
}

/// The socket that interrupt() shuts down; -1: none.
void Connection::use(int socket) noexcept {
  const std::lock_guard lock(mutex_);
  socket_ = socket;
}

void Connection::interrupt() noexcept {
  const std::lock_guard lock(mutex_);
  timeout_ns_ = std::min(timeout_ns_.load(), kLastWaitNs);
  if (socket_ >= 0) ::shutdown(socket_, SHUT_RDWR);
}

ExchangeResult Connection::connect_socket(int socket) const noexcept {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port_);
  if (inet_pton(AF_INET, host_.c_str(), &to.sin_addr) != 1)
    return {ExchangeStatus::disconnected, "connect: no IPv4 address", EINVAL};
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) return {};
  if (errno != EINPROGRESS) return {ExchangeStatus::disconnected, "connect", errno};
  pollfd wait{socket, POLLOUT, 0};
  if (::poll(&wait, 1, whole_ms(timeout_ns_)) <= 0)
    return {ExchangeStatus::disconnected, "connect", ETIMEDOUT};
  int error = 0;
  socklen_t size = sizeof error;
  if (getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) != 0) error = errno;
  if (error != 0) return {ExchangeStatus::disconnected, "connect", error};
  return {};
}

ExchangeResult Connection::open() noexcept {
  close();
  // Connecting is done here: libmodbus's own aborts the process on a descriptor that FD_SET cannot take.
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket < 0) return {ExchangeStatus::disconnected, "socket", errno};
  use(socket);
  ExchangeResult result;
  if (socket >= FD_SETSIZE) result = {ExchangeStatus::disconnected, "more than 1024 open files", EMFILE};
  if (result.status == ExchangeStatus::ok) result = connect_socket(socket);
  if (result.status == ExchangeStatus::ok) {
    set_options(socket);
    context_ = modbus_new_tcp(host_.c_str(), port_);
    if (context_ == nullptr) result = {ExchangeStatus::disconnected, "connect", errno};
  }
  if (result.status != ExchangeStatus::ok) {
    use(-1);
    ::close(socket);
    return result;
  }
  modbus_set_socket(context_, socket);
  modbus_set_error_recovery(context_, MODBUS_ERROR_RECOVERY_NONE);
  const std::int64_t timeout_ns = timeout_ns_;
  const auto seconds = static_cast<std::uint32_t>(timeout_ns / kNsPerS);
  const auto microseconds = static_cast<std::uint32_t>(timeout_ns % kNsPerS / 1'000);
  modbus_set_response_timeout(context_, seconds, microseconds);
  modbus_set_byte_timeout(context_, 0,
                          0);  // the response time-out limits the whole reply, however slowly it drips
  return {};
}

ExchangeResult Connection::receive(const Adu& request) noexcept {
  const int size = modbus_receive_confirmation(context_, reply_.data());
  if (size < 0) {
    const int error = errno;
    if (is_timeout(error)) return {ExchangeStatus::timeout, "", error};
    // Junk ends as one of libmodbus's own codes; all others are the socket's.
    if (error >= MODBUS_ENOBASE) return {ExchangeStatus::protocol, "not a Modbus reply", 0};
    return {ExchangeStatus::disconnected, "", error};
  }
  reply_size_ = static_cast<std::size_t>(size);
  return judge(request, reply());
}

ExchangeResult Connection::transact(const Adu& request) noexcept {
  if (!is_open()) return {ExchangeStatus::disconnected, "", ENOTCONN};
  // libmodbus's raw request has no transaction number, by which a late reply is told from the one waited for.
  const ssize_t sent = ::send(modbus_get_socket(context_), request.bytes.data(), request.size, MSG_NOSIGNAL);
  ExchangeResult result;
  if (sent != static_cast<ssize_t>(request.size)) {
    const int error = sent < 0 ? errno : EAGAIN;
    result = {is_timeout(error) ? ExchangeStatus::timeout : ExchangeStatus::disconnected, "", error};
  } else {
    result = receive(request);
  }
  if (result.status != ExchangeStatus::ok && result.status != ExchangeStatus::exception) close();
  return result;
}

}  // namespace stationd::io::modbus

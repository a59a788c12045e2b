// Device: the thread that exchanges one field device's values with the stations that use it.
// Owned by the controller; owns its backend and connection.
// start(), request_stop(), stop() from the composing thread; its own thread is plain: it may block.
#pragma once

#include <pthread.h>

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "io/backend.hpp"
#include "io/device_rules.hpp"
#include "io/options.hpp"
#include "scan/clock.hpp"

namespace stationd::io {

/// A line for the log, from the device's thread: severity 0 debug .. 3 error.
using DeviceLog = std::function<void(int severity, const std::string& text)>;

/// Counters of a device, for any thread.
struct DeviceCounters {
  std::atomic<bool> connected{false};       ///< the last round was good
  std::atomic<std::uint64_t> exchanges{0};  ///< good rounds
  std::atomic<std::uint64_t> failures{0};   ///< all others; by ExchangeStatus:
  std::array<std::atomic<std::uint64_t>, 5> failures_by_status{};
  std::atomic<std::uint64_t> skipped{0};    ///< rounds left out because one before took too long
  std::atomic<std::int64_t> last_ok_ns{0};  ///< CLOCK_MONOTONIC; 0: never
};

class Device {
 public:
  /// CLOCK_MONOTONIC in nanoseconds; tests bring their own.
  using Clock = std::int64_t (*)();

  Device(DeviceOptions options, std::unique_ptr<Backend> backend, const std::vector<Point>& points,
         std::vector<DeviceBinding> bindings, DeviceLog log, Clock clock = monotonic_ns);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// From a thread that is not real-time: the new one inherits its policy. Throws SetupError.
  void start();
  /// Asks the thread to write safe values once more and end; does not wait.
  void request_stop() noexcept;
  /// Whether the thread has ended by then (CLOCK_MONOTONIC); waits for it that long.
  bool ended_by(std::int64_t until_ns);
  /// Leaves a thread that has not ended little time: see Backend::interrupt().
  void interrupt() noexcept { backend_->interrupt(); }
  /// Waits for the thread's end: some times the device's time-out, or half a second after interrupt().
  void stop() noexcept;

  const DeviceOptions& options() const noexcept { return options_; }
  const DeviceCounters& counters() const noexcept { return counters_; }
  /// Any thread: what the last failure was; empty: there was none.
  std::string last_error() const;

  /// One round at now_ns; the thread's body, and what tests call without a thread. True: the device answered.
  bool round(std::int64_t now_ns);
  /// The thread's last act, also for tests: a round of safe values, a second one over a new connection if
  /// that fails, then the connection's end.
  void finish(std::int64_t now_ns);

 private:
  static void* thread_main(void* self);
  void loop();
  void publish_inputs(std::int64_t receipt_ns) noexcept;
  void count(const ExchangeResult& result, std::int64_t now_ns);

  static constexpr std::size_t kStackBytes = 256 * 1024;  // memory is locked: every stack counts

  const DeviceOptions options_;
  std::unique_ptr<Backend> backend_;
  std::vector<DeviceBinding> bindings_;
  OutputSelection selection_;
  DeviceReport report_;
  DeviceLog log_;
  Clock clock_;
  std::vector<Slot> inputs_;
  std::vector<std::uint64_t> published_;
  DeviceCounters counters_;
  bool returning_ = true;
  mutable std::mutex error_mutex_;
  std::string last_error_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  bool ended_ = false;
  bool running_ = false;
  pthread_t thread_{};
};

/// Writes the safe value of every output that has one (not `hold`), once. For `stationd --write-safe`.
ExchangeResult write_safe(Backend& backend, const std::vector<Point>& points, std::int64_t now_ns);

}  // namespace stationd::io

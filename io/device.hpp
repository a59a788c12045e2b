// Device: the thread that exchanges one field device's values with the stations that use it.
// Owned by the controller; owns its backend and connection.
// start(), request_stop(), stop() from the composing thread; the thread itself is plain (normal scheduling, may block).
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "io/backend.hpp"
#include "io/options.hpp"
#include "scan/links.hpp"

namespace stationd::io {

/// One station's share of a device. Links may be null; `permit` may not.
struct DeviceBinding {
  InputLink* inputs = nullptr;
  OutputLink* outputs = nullptr;
  const std::atomic<bool>* permit = nullptr;
  std::vector<std::uint32_t> input_points;   ///< for each tag of `inputs`: its place among the device's input points
  std::vector<std::uint32_t> output_points;  ///< for each tag of `outputs`: its place among the device's output points
};

/// What becomes of the outputs of one round; pure. The program's values stand only with the permit, once a scan has committed, and not
/// in the first round after the device was away (`returning`): it gets safe values first.
class OutputSelection {
 public:
  OutputSelection(const std::vector<Point>& points, std::vector<DeviceBinding>& bindings);
  const std::vector<OutputValue>& select(bool returning) noexcept;

 private:
  std::vector<OutputValue> safe_;
  std::vector<OutputValue> now_;
  std::vector<DeviceBinding>& bindings_;
};

/// A line for the log, from the device's thread: severity 0 debug .. 3 error.
using DeviceLog = std::function<void(int severity, const std::string& text)>;

/// Counters of a device, for any thread.
struct DeviceCounters {
  std::atomic<bool> connected{false};
  std::atomic<std::uint64_t> exchanges{0};
  std::atomic<std::uint64_t> failures{0};
  std::atomic<std::uint64_t> skipped{0};  ///< rounds of the grid that fell out because one before took too long
};

class Device {
 public:
  Device(DeviceOptions options, std::unique_ptr<Backend> backend, std::vector<Point> points,
         std::vector<DeviceBinding> bindings, DeviceLog log);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  void start();
  /// Asks the thread to write safe values once more and end; does not wait.
  void request_stop() noexcept;
  /// Waits for that: at most about the device's time-out.
  void stop() noexcept;

  const DeviceOptions& options() const noexcept { return options_; }
  const DeviceCounters& counters() const noexcept { return counters_; }

  /// One round at now_ns; the thread's body, and what tests call without a thread. True if the device answered.
  bool round(std::int64_t now_ns);

 private:
  void loop();
  void publish_inputs(std::int64_t receipt_ns) noexcept;
  void say_change(const ExchangeResult& result, std::int64_t now_ns);

  static constexpr std::int64_t kLogEveryNs = 1'000'000'000;

  DeviceOptions options_;
  std::unique_ptr<Backend> backend_;
  std::vector<DeviceBinding> bindings_;
  OutputSelection selection_;
  DeviceLog log_;
  std::vector<Slot> inputs_;
  std::vector<std::uint64_t> published_;
  DeviceCounters counters_;
  bool returning_ = true;
  bool contacted_ = false;
  bool complained_ = false;
  std::int64_t lost_ns_ = 0;
  std::int64_t next_log_ns_ = 0;
  std::uint64_t unsaid_ = 0;
  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
};

/// Writes the safe value of every output that has one (not `hold`), once. For `stationd --write-safe`.
ExchangeResult write_safe(Backend& backend, const std::vector<Point>& points, std::int64_t now_ns);

}  // namespace stationd::io

#include "io/device.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>

#include "scan/error.hpp"
#include "scan/schedule.hpp"

namespace stationd::io {

Device::Device(DeviceOptions options, std::unique_ptr<Backend> backend, const std::vector<Point>& points,
               std::vector<DeviceBinding> bindings, DeviceLog log, Clock clock)
    : options_(std::move(options)), backend_(std::move(backend)), bindings_(std::move(bindings)),
      selection_(points, bindings_), report_(options_), log_(std::move(log)), clock_(clock),
      inputs_(count_of(points, Direction::input)), published_(bindings_.size()) {}

Device::~Device() {
  request_stop();
  stop();
}

void Device::start() {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStackBytes);
  const int error = pthread_create(&thread_, &attributes, thread_main, this);
  pthread_attr_destroy(&attributes);
  if (error != 0) throw SetupError("device " + options_.name + ": no thread: " + std::strerror(error));
  running_ = true;
  pthread_setname_np(thread_, ("io-" + options_.name).substr(0, 15).c_str());
}

void* Device::thread_main(void* self) {
  static_cast<Device*>(self)->loop();
  return nullptr;
}

void Device::request_stop() noexcept {
  const std::lock_guard lock(mutex_);
  stop_ = true;
  wake_.notify_all();
}

void Device::stop() noexcept {
  if (running_) pthread_join(thread_, nullptr);
  running_ = false;
}

bool Device::ended_by(std::int64_t until_ns) {
  if (!running_) return true;
  std::unique_lock lock(mutex_);
  const std::chrono::steady_clock::time_point until{std::chrono::nanoseconds(until_ns)};
  return wake_.wait_until(lock, until, [this] { return ended_; });
}

void Device::loop() {
  const Schedule grid(clock_(), 0, options_.period_ns);
  std::uint64_t k = 0;
  std::unique_lock lock(mutex_);
  while (!stop_) {
    lock.unlock();
    round(clock_());
    lock.lock();
    const std::uint64_t next = grid.next(k, clock_());
    counters_.skipped.fetch_add(next - k - 1, std::memory_order_relaxed);
    k = next;
    const std::chrono::steady_clock::time_point until{std::chrono::nanoseconds(grid.due_ns(k))};
    wake_.wait_until(lock, until, [this] { return stop_; });
  }
  lock.unlock();
  finish(clock_());
  lock.lock();
  ended_ = true;
  wake_.notify_all();
}

void Device::finish(std::int64_t now_ns) {
  returning_ = true;  // the last round is a safe one, whatever the permits say
  bool safe = round(now_ns);
  if (!safe) {
    // Its connection was lost, perhaps rounds ago, and waits for its next turn: the device may well be there.
    backend_->close();
    safe = round(clock_());
  }
  if (!safe && log_)
    log_(3, "device " + options_.name + ": safe values NOT written at the end: " + last_error());
  backend_->close();
}

bool Device::round(std::int64_t now_ns) {
  const ExchangeResult result = backend_->exchange(selection_.select(returning_), inputs_, now_ns);
  const std::int64_t receipt_ns = clock_();
  const bool ok = result.status == ExchangeStatus::ok;
  if (ok) publish_inputs(receipt_ns);
  count(result, receipt_ns);
  returning_ = !ok;  // what a failed round wrote is unknown: a round of safe values settles it
  return ok;
}

void Device::count(const ExchangeResult& result, std::int64_t now_ns) {
  const bool ok = result.status == ExchangeStatus::ok;
  if (ok) {
    counters_.exchanges.fetch_add(1, std::memory_order_relaxed);
    counters_.last_ok_ns.store(now_ns, std::memory_order_relaxed);
  } else {
    counters_.failures.fetch_add(1, std::memory_order_relaxed);
    counters_.failures_by_status[static_cast<std::size_t>(result.status)].fetch_add(
        1, std::memory_order_relaxed);
    const std::lock_guard lock(error_mutex_);
    last_error_ = describe(result);
  }
  counters_.connected.store(ok, std::memory_order_relaxed);
  const DeviceLine line = report_.line(result, now_ns);
  if (!line.text.empty() && log_) log_(line.severity, line.text);
}

void Device::publish_inputs(std::int64_t receipt_ns) noexcept {
  for (std::size_t b = 0; b < bindings_.size(); ++b) {
    InputLink* link = bindings_[b].inputs;
    if (link == nullptr) continue;
    const BlockView block{link->blocks.writable(), link->tags.layout};
    for (std::size_t i = 0; i < bindings_[b].input_points.size(); ++i)
      block.slots()[i] = inputs_[bindings_[b].input_points[i]];
    std::fill(block.qualities().begin(), block.qualities().end(), Quality::GOOD);
    block.header() = {receipt_ns, 0, 0, ++published_[b], Quality::GOOD};
    link->blocks.publish();
  }
}

std::string Device::last_error() const {
  const std::lock_guard lock(error_mutex_);
  return last_error_;
}

ExchangeResult write_safe(Backend& backend, const std::vector<Point>& points, std::int64_t now_ns) {
  std::vector<Slot> inputs(count_of(points, Direction::input));
  return backend.exchange(safe_values(points), inputs, now_ns);
}

}  // namespace stationd::io

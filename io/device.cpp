#include "io/device.hpp"

#include <pthread.h>

#include <algorithm>
#include <chrono>

#include "scan/schedule.hpp"

namespace stationd::io {
namespace {

std::int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

std::vector<OutputValue> safe_values(const std::vector<Point>& points) {
  std::vector<OutputValue> values;
  for (const Point& p : points)
    if (p.direction == Direction::output) values.push_back({p.safe_value, p.safe_action == SafeAction::value});
  return values;
}

std::size_t count_inputs(const std::vector<Point>& points) {
  return static_cast<std::size_t>(
      std::count_if(points.begin(), points.end(), [](const Point& p) { return p.direction == Direction::input; }));
}

std::string describe(const ExchangeResult& result) {
  static constexpr const char* names[] = {"ok", "no connection", "no answer in time", "answer breaks the protocol",
                                          "request refused by the device"};
  std::string text = names[static_cast<std::size_t>(result.status)];
  if (result.detail != nullptr && *result.detail != '\0') text += std::string(" (") + result.detail + ")";
  if (result.code != 0) text += ", code " + std::to_string(result.code);
  return text;
}

}  // namespace

OutputSelection::OutputSelection(const std::vector<Point>& points, std::vector<DeviceBinding>& bindings)
    : safe_(safe_values(points)), now_(safe_), bindings_(bindings) {}

const std::vector<OutputValue>& OutputSelection::select(bool returning) noexcept {
  std::copy(safe_.begin(), safe_.end(), now_.begin());
  for (DeviceBinding& b : bindings_) {
    if (b.outputs == nullptr) continue;
    // The permit is read before the block: a block that is newer than the permit can only be safer.
    const bool permitted = b.permit->load(std::memory_order_acquire);
    b.outputs->blocks.update();
    const ConstBlockView block{b.outputs->blocks.readable(), b.outputs->tags.layout};
    if (!permitted || returning || block.header().count == 0) continue;
    for (std::size_t i = 0; i < b.output_points.size(); ++i) now_[b.output_points[i]] = {block.slots()[i], true};
  }
  return now_;
}

Device::Device(DeviceOptions options, std::unique_ptr<Backend> backend, std::vector<Point> points,
               std::vector<DeviceBinding> bindings, DeviceLog log)
    : options_(std::move(options)),
      backend_(std::move(backend)),
      bindings_(std::move(bindings)),
      selection_(points, bindings_),
      log_(std::move(log)),
      inputs_(count_inputs(points)),
      published_(bindings_.size()) {}

Device::~Device() {
  request_stop();
  stop();
}

void Device::start() {
  thread_ = std::thread([this] { loop(); });
  pthread_setname_np(thread_.native_handle(), ("io-" + options_.name).substr(0, 15).c_str());
}

void Device::request_stop() noexcept {
  const std::lock_guard lock(mutex_);
  stop_ = true;
  wake_.notify_all();
}

void Device::stop() noexcept {
  if (thread_.joinable()) thread_.join();
}

void Device::loop() {
  const Schedule grid(steady_ns(), 0, options_.period_ns);
  std::uint64_t k = 0;
  std::unique_lock lock(mutex_);
  while (!stop_) {
    lock.unlock();
    round(steady_ns());
    lock.lock();
    const std::uint64_t next = grid.next(k, steady_ns());
    counters_.skipped.fetch_add(next - k - 1, std::memory_order_relaxed);
    k = next;
    const std::chrono::steady_clock::time_point until{std::chrono::nanoseconds(grid.due_ns(k))};
    wake_.wait_until(lock, until, [this] { return stop_; });
  }
  lock.unlock();
  if (!returning_) {
    returning_ = true;  // the last round is a safe one, whatever the permits say
    round(steady_ns());
  }
  backend_->close();
}

bool Device::round(std::int64_t now_ns) {
  const ExchangeResult result = backend_->exchange(selection_.select(returning_), inputs_, now_ns);
  const bool ok = result.status == ExchangeStatus::ok;
  if (ok) {
    publish_inputs(steady_ns());
    counters_.exchanges.fetch_add(1, std::memory_order_relaxed);
  } else {
    counters_.failures.fetch_add(1, std::memory_order_relaxed);
  }
  say_change(result, now_ns);
  counters_.connected.store(ok, std::memory_order_relaxed);
  returning_ = !ok;
  return ok;
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

void Device::say_change(const ExchangeResult& result, std::int64_t now_ns) {
  const bool ok = result.status == ExchangeStatus::ok;
  const bool was = counters_.connected.load(std::memory_order_relaxed);
  if (ok == was && (ok || complained_)) return;
  if (!ok && was) lost_ns_ = now_ns;
  if (now_ns < next_log_ns_) {
    ++unsaid_;
    if (!ok) complained_ = true;
    return;
  }
  const std::string where = "device " + options_.name + " (" + options_.host + ":" + std::to_string(options_.port) +
                            " unit " + std::to_string(options_.unit) + ")";
  const std::string more = unsaid_ == 0 ? "" : "; " + std::to_string(unsaid_) + " changes before this were not said";
  if (ok && !contacted_) log_(1, where + ": connected" + more);
  else if (ok) log_(1, where + ": back after " + std::to_string((now_ns - lost_ns_) / 1'000'000) + " ms; safe values first" + more);
  else log_(2, where + (contacted_ ? ": lost: " : ": not reached yet: ") + describe(result) + more);
  contacted_ = contacted_ || ok;
  complained_ = !ok;
  unsaid_ = 0;
  next_log_ns_ = now_ns + kLogEveryNs;
}

ExchangeResult write_safe(Backend& backend, const std::vector<Point>& points, std::int64_t now_ns) {
  std::vector<Slot> inputs(count_inputs(points));
  return backend.exchange(safe_values(points), inputs, now_ns);
}

}  // namespace stationd::io

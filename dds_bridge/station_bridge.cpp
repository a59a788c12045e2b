#include "dds_bridge/station_bridge.hpp"

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <thread>
#include <utility>

#include "dds_bridge/bridge_context.hpp"
#include "dds_bridge/bus_out.hpp"
#include "dds_bridge/duplicate.hpp"
#include "dds_bridge/event_writer.hpp"
#include "dds_bridge/orders.hpp"
#include "dds_bridge/remote_inputs.hpp"
#include "scan/clock.hpp"

namespace stationd::bus {
namespace {

constexpr int kLongestWaitMs = 50;
constexpr std::int64_t kFlushNs = 500'000'000;

class EventFd {
 public:
  EventFd() : fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    if (fd_ < 0) throw BusError(std::string("no eventfd for the bus: ") + std::strerror(errno));
  }
  ~EventFd() { close(fd_); }
  EventFd(const EventFd&) = delete;
  EventFd& operator=(const EventFd&) = delete;
  int fd() const noexcept { return fd_; }
  void set() const noexcept {
    const std::uint64_t one = 1;
    static_cast<void>(!write(fd_, &one, sizeof(one)));  // full means that it is set
  }
  void wait(int timeout_ms) const noexcept {
    pollfd poll_fd{fd_, POLLIN, 0};
    std::uint64_t count = 0;
    if (poll(&poll_fd, 1, timeout_ms) > 0) static_cast<void>(!read(fd_, &count, sizeof(count)));
  }

 private:
  int fd_;
};

}  // namespace

struct StationBridge::Impl {
  Impl(Bus& bus, BridgeOptions options, LogSink log)
      : context(bus, std::move(options), std::move(log)), events(context), orders(context),
        watch(bus.self(), context.options.newcomer_ns) {}

  Handlers handlers();
  void run();
  void on_status(const Status& status, const Origin& origin);
  void report(const Status& status, bool give_way);
  void watch_bus(std::int64_t now_ns);

  Context context;
  EventWriter events;
  Orders orders;
  RemoteInputs inputs;
  DuplicateWatch watch;
  std::unique_ptr<BusOut> out;
  EventFd wake;
  std::thread thread;
  std::atomic<bool> end{false};
  std::int64_t listen_until_ns = 0;
  std::uint64_t malformed_said = 0, failures_said = 0;
  mutable std::mutex duplicate_mutex;
  std::string duplicate;
};

Handlers StationBridge::Impl::handlers() {
  Handlers handlers;
  handlers.stations = inputs.stations();
  for (const auto& entry : context.stations) {
    const std::string& name = entry->station->name();
    handlers.names.push_back(name);
    if (std::ranges::find(handlers.stations, name) == handlers.stations.end())
      handlers.stations.push_back(name);
  }
  if (inputs.wants(TopicId::set)) {
    handlers.on_set = [this](const Set& m, const Origin& o) {
      inputs.put(TopicId::set, m.STATION, &m, o.receipt_ns);
    };
  }
  if (inputs.wants(TopicId::end)) {
    handlers.on_end = [this](const End& m, const Origin& o) {
      inputs.put(TopicId::end, m.STATION, &m, o.receipt_ns);
    };
  }
  handlers.on_status = [this](const Status& m, const Origin& o) { on_status(m, o); };
  handlers.on_start = [this](const MsgReq& m, const Origin& o) { orders.on_start(m, o); };
  handlers.on_stop = [this](const MsgReq& m, const Origin& o) { orders.on_stop(m, o); };
  handlers.on_request = [this](const MsgReq& m, const Origin& o) { orders.on_request(m, o); };
  handlers.on_incompatible = [this](const std::string& topic, const std::string& policy) {
    context.log.say("qos" + topic, 2,
                    "a peer's endpoint of topic " + topic + " does not match: its QoS policy " + policy +
                        " is not compatible with ours",
                    monotonic_ns());
  };
  return handlers;
}

void StationBridge::Impl::on_status(const Status& status, const Origin& origin) {
  inputs.put(TopicId::status, status.STATION, &status, origin.receipt_ns);
  if (context.find(status.STATION) == nullptr) return;
  const DuplicateWatch::Verdict verdict = watch.on_status(status, origin, monotonic_ns());
  if (verdict != DuplicateWatch::Verdict::none) report(status, verdict == DuplicateWatch::Verdict::give_way);
}

void StationBridge::Impl::report(const Status& status, bool give_way) {
  const std::string text = "station " + status.STATION + " is run by another daemon as well, on controller " +
                           (status.CONTROLLER.empty() ? "(unnamed)" : status.CONTROLLER);
  if (!give_way) {
    context.log.say("duplicate" + status.STATION, 3, text + ": both publish and both obey; stop one of them",
                    monotonic_ns());
    return;
  }
  {
    const std::lock_guard lock(duplicate_mutex);
    if (!duplicate.empty()) return;
    duplicate = status.STATION;
  }
  context.gave_way = true;
  context.log.say("duplicate" + status.STATION, 3, text + ": this one gives way", monotonic_ns());
}

void StationBridge::Impl::run() {
  pthread_setname_np(pthread_self(), "bus-out");
  while (!end) {
    wake.wait(kLongestWaitMs);
    const std::int64_t now_ns = monotonic_ns();
    if (now_ns >= listen_until_ns) context.listening = false;
    out->pass(now_ns);
    watch_bus(now_ns);
  }
  out->pass(monotonic_ns());
  out->farewell();
}

void StationBridge::Impl::watch_bus(std::int64_t now_ns) {
  const std::uint64_t malformed = context.bus.malformed(), failures = context.bus.failures();
  if (malformed != malformed_said) {
    context.log.say("malformed", 2,
                    "samples that could not be read, since start: " + std::to_string(malformed), now_ns);
    malformed_said = malformed;
  }
  if (failures != failures_said) {
    context.log.say("failures", 2, "samples that DDS did not take, since start: " + std::to_string(failures),
                    now_ns);
    failures_said = failures;
  }
  context.log.flush(now_ns);
}

StationBridge::StationBridge(Bus& bus, BridgeOptions options, std::vector<BridgedStation> stations,
                             LogSink log)
    : impl_(std::make_unique<Impl>(bus, std::move(options), std::move(log))) {
  for (BridgedStation& bridged : stations) {
    Station& station = *bridged.station;
    if (impl_->context.find(station.name()) != nullptr) {
      throw BusError("two stations of one controller are called " + station.name());
    }
    impl_->context.stations.push_back(std::make_unique<BridgedEntry>(std::move(bridged)));
    impl_->inputs.add(station);
  }
  impl_->out = std::make_unique<BusOut>(impl_->context, impl_->events);
  std::vector<std::string> topics = impl_->out->topics();
  for (const char* topic : {"Status", "ScanStats", "GSE", "Msg_Res"}) topics.emplace_back(topic);
  bus.prepare_writers(topics);
}

StationBridge::~StationBridge() { stop(); }

int StationBridge::wake_fd() const noexcept { return impl_->wake.fd(); }

void StationBridge::start() {
  const std::int64_t now_ns = monotonic_ns();
  impl_->watch.start(now_ns);
  impl_->listen_until_ns = now_ns + impl_->context.options.listen_ns;
  impl_->context.listening = impl_->context.options.listen_ns > 0;
  impl_->context.bus.start(impl_->handlers());
  impl_->events.start();
  impl_->thread = std::thread([this] { impl_->run(); });
}

void StationBridge::stop() noexcept {
  if (!impl_->thread.joinable()) return;
  const std::int64_t deadline_ns = monotonic_ns() + kFlushNs;
  impl_->context.closed = true;
  impl_->context.bus.stop();
  impl_->end = true;
  impl_->wake.set();
  impl_->thread.join();
  impl_->events.stop(deadline_ns);
}

std::string StationBridge::duplicate_station() const {
  const std::lock_guard lock(impl_->duplicate_mutex);
  return impl_->duplicate;
}

int StationBridge::stats_readers() const { return impl_->context.bus.matched_readers("ScanStats"); }

void StationBridge::publish(const ScanStats& stats) {
  if (!impl_->context.quiet() && !impl_->context.closed.load()) impl_->context.bus.write(stats);
}

BridgeFigures StationBridge::figures() const noexcept {
  const Counters& counters = impl_->context.counters;
  BridgeFigures figures;
  figures.orders_refused = counters.orders_refused.load(std::memory_order_relaxed);
  figures.orders_busy = counters.orders_busy.load(std::memory_order_relaxed);
  figures.events_waiting = impl_->events.waiting();
  figures.events_lost = counters.events_lost.load(std::memory_order_relaxed);
  figures.replies_lost = counters.replies_lost.load(std::memory_order_relaxed);
  return figures;
}

}  // namespace stationd::bus

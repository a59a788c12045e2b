#include "dds_bridge/event_writer.hpp"

#include <pthread.h>

#include <chrono>
#include <utility>

#include "scan/clock.hpp"

namespace stationd::bus {
namespace {

constexpr auto kRetry = std::chrono::milliseconds(5);

}  // namespace

EventWriter::~EventWriter() { stop(0); }

void EventWriter::start() {
  thread_ = std::thread([this] { run(); });
}

void EventWriter::put(Gse event) {
  bool lost = false;
  {
    const std::lock_guard lock(mutex_);
    lost = backlog_.size() >= context_.options.event_backlog;
    if (lost) backlog_.pop_front();
    backlog_.push_back(std::move(event));
  }
  wake_.notify_one();
  if (!lost) return;
  context_.counters.events_lost.fetch_add(1, std::memory_order_relaxed);
  context_.log.say("events", 3,
                   "events lost: a reader does not take them and the backlog is full (see the gap in SEQ)",
                   monotonic_ns());
}

void EventWriter::stop(std::int64_t deadline_ns) noexcept {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
    deadline_ns_ = deadline_ns;
  }
  wake_.notify_one();
  thread_.join();
}

std::size_t EventWriter::waiting() const {
  const std::lock_guard lock(mutex_);
  return backlog_.size();
}

/// An event leaves the backlog only when DDS has taken it; until then it is tried again.
void EventWriter::run() {
  pthread_setname_np(pthread_self(), "bus-events");
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return end_ || !backlog_.empty(); });
    if (end_ && (backlog_.empty() || monotonic_ns() >= deadline_ns_)) return;
    Gse event = std::move(backlog_.front());
    backlog_.pop_front();
    lock.unlock();
    const bool written = context_.bus.write(event);
    lock.lock();
    if (written) continue;
    backlog_.push_front(std::move(event));
    wake_.wait_for(lock, kRetry, [this] { return end_; });
    if (end_) {  // the predicate holds now: sleep for the pause all the same
      lock.unlock();
      std::this_thread::sleep_for(kRetry);
      lock.lock();
    }
  }
}

}  // namespace stationd::bus

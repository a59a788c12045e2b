#include "scan/rt_watchdog.hpp"

#include <time.h>

#include <algorithm>
#include <cstring>

#include "scan/clock.hpp"
#include "scan/error.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::size_t kStackBytes = 256 * 1024;

std::int64_t round_for(const std::vector<RtWatchdog::Watched>& watched) {
  std::int64_t shortest_ns = 500 * kMs;
  for (const RtWatchdog::Watched& w : watched) shortest_ns = std::min(shortest_ns, w.limit_ns);
  return std::max(shortest_ns / 10, kMs);
}

void sleep_until(std::int64_t due_ns) noexcept {
  const timespec at{due_ns / kSecond, due_ns % kSecond};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
}

}  // namespace

RtWatchdog::RtWatchdog(std::vector<Watched> watched)
    : watched_(std::move(watched)), round_ns_(round_for(watched_)) {
  for (const Watched& w : watched_) watches_.emplace_back(w.limit_ns, round_ns_);
  idle_.reserve(watched_.size());
  marks_.resize(watched_.size());
}

RtWatchdog::~RtWatchdog() { stop(); }

std::vector<RtGrant> RtWatchdog::start(const std::atomic<std::int64_t>& utc_offset_ns) {
  utc_offset_ns_ = &utc_offset_ns;
  last_round_ns_.store(monotonic_ns(), std::memory_order_relaxed);
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStackBytes);
  const int made = pthread_create(&thread_, &attributes, &RtWatchdog::entry, this);
  pthread_attr_destroy(&attributes);
  if (made != 0) throw SetupError(std::string("no thread for the watchdog: ") + std::strerror(made));
  started_ = true;
  pthread_setname_np(thread_, "watchdog");
  const bool wanted =
      std::any_of(watched_.begin(), watched_.end(), [](auto& w) { return w.thread->priority() > 0; });
  if (!wanted) return {};
  return {ask_for_fifo(thread_, kPriority, "watchdog ")};
}

void RtWatchdog::stop() noexcept {
  if (!started_) return;
  stop_.store(true, std::memory_order_release);
  pthread_join(thread_, nullptr);
  started_ = false;
}

bool RtWatchdog::stalled(std::int64_t now_ns) const noexcept {
  return now_ns - last_round_ns_.load(std::memory_order_relaxed) > round_ns_ + kSecond;
}

void* RtWatchdog::entry(void* self) {
  static_cast<RtWatchdog*>(self)->loop();
  return nullptr;
}

void RtWatchdog::loop() noexcept {
  std::int64_t last_ns = monotonic_ns();
  while (!stop_.load(std::memory_order_acquire)) {
    sleep_until(last_ns + round_ns_);
    const std::int64_t now_ns = monotonic_ns();
    round(now_ns, now_ns - last_ns);
    last_ns = now_ns;
    last_round_ns_.store(now_ns, std::memory_order_relaxed);
  }
}

/// Those that use the CPU first: where one of them is stuck, the others may have waited for that CPU.
void RtWatchdog::round(std::int64_t now_ns, std::int64_t elapsed_ns) noexcept {
  bool stuck = false;
  idle_.clear();
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    if (uses_cpu(i))
      stuck = judge(i, now_ns, elapsed_ns) || stuck;
    else
      idle_.push_back(i);
  }
  for (const std::size_t i : idle_) {
    if (stuck)
      watches_[i].forgive();
    else
      judge(i, now_ns, elapsed_ns);
  }
}

/// At least half of the time that it makes no progress.
bool RtWatchdog::uses_cpu(std::size_t index) noexcept {
  const RtThread& thread = *watched_[index].thread;
  Mark& mark = marks_[index];
  const std::int64_t owed_since_ns = thread.owed_since_ns();
  const std::int64_t cpu_ns = thread.cpu_ns();
  if (owed_since_ns != mark.owed_since_ns) mark = {owed_since_ns, cpu_ns};
  return 2 * (cpu_ns - mark.cpu_ns) > watches_[index].idle_ns();
}

/// True if it is stuck from now on.
bool RtWatchdog::judge(std::size_t index, std::int64_t now_ns, std::int64_t elapsed_ns) noexcept {
  RtThread& thread = *watched_[index].thread;
  const std::int64_t idle_ns = watches_[index].idle_ns();
  switch (watches_[index].judge(thread.owed_since_ns(), now_ns, elapsed_ns)) {
    case Progress::fine: break;
    case Progress::stuck: revoke(index); return true;
    case Progress::recovered:
      stuck_.fetch_sub(1, std::memory_order_relaxed);
      reports_.push({static_cast<std::uint32_t>(index), false, idle_ns, -1, thread.promote()});
      break;
  }
  return false;
}

/// The permits first: what the I/O threads send from now on is safe. Then the CPU is theirs again.
void RtWatchdog::revoke(std::size_t index) noexcept {
  const std::vector<Station*>& stations = watched_[index].task->stations();
  Report report{static_cast<std::uint32_t>(index), true, watches_[index].idle_ns(), -1, false};
  const std::int64_t utc_ns = monotonic_ns() + utc_offset_ns_->load(std::memory_order_relaxed);
  for (std::size_t s = 0; s < stations.size(); ++s) {
    if (stations[s]->port().executing.load(std::memory_order_relaxed))
      report.station = static_cast<std::int32_t>(s);
    stations[s]->port().hang(report.idle_ns, utc_ns);
  }
  report.demoted = watched_[index].thread->demote();
  stuck_.fetch_add(1, std::memory_order_relaxed);
  reports_.push(report);
}

}  // namespace stationd

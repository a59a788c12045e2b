#include "scan/rt_thread.hpp"

#include <alloca.h>
#include <sched.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "scan/error.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;
constexpr std::size_t kStackBytes = 256 * 1024;
constexpr std::size_t kPrefaultBytes = 128 * 1024;
constexpr int kLeast = 19;            // nice value of a stuck thread
constexpr int kWakeSignal = SIGUSR1;  // interrupts the wait for a due time

void prefault_stack() noexcept {
  volatile unsigned char* stack = static_cast<unsigned char*>(alloca(kPrefaultBytes));
  for (std::size_t i = 0; i < kPrefaultBytes; i += 4096) stack[i] = 0;
}

void install_wake_signal() {
  struct sigaction action {};
  action.sa_handler = [](int) {};
  sigaction(kWakeSignal, &action, nullptr);
}

/// Even where the creator blocks every signal, as daemons that take theirs by sigwait do.
void receive_wake_signal() noexcept {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, kWakeSignal);
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

}  // namespace

void EventfdWaker::wake() noexcept {
  const std::uint64_t one = 1;
  // One of the scan's two system calls. The descriptor is non-blocking; EAGAIN means that the reader has yet
  // to look, and nothing is lost.
  STATIOND_TRUSTED(static_cast<void>(!write(descriptor_, &one, sizeof one)));
}

RtThread::RtThread(Task& task, RtOptions options, const std::atomic<std::int64_t>& utc_offset_ns)
    : task_(task), options_(options), waker_(options.wake_fd), utc_offset_ns_(utc_offset_ns) {
  if (options_.wake_fd >= 0) task_.set_waker(&waker_);
}

RtThread::~RtThread() {
  if (started_) stop(kSecondNs);
  if (!started_ && options_.wake_fd >= 0) task_.set_waker(nullptr);
}

std::vector<RtGrant> RtThread::start() {
  install_wake_signal();
  std::vector<RtGrant> grants;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStackBytes);
  const int made = pthread_create(&thread_, &attributes, &RtThread::entry, this);
  pthread_attr_destroy(&attributes);
  if (made != 0) throw SetupError("no thread for task " + task_.options().name + ": " + std::strerror(made));
  started_ = true;
  pthread_getcpuclockid(thread_, &cpu_clock_);
  pthread_setname_np(thread_, ("scan-" + task_.options().name).substr(0, 15).c_str());
  if (options_.cpu >= 0) grants.push_back(ask_for_cpu(thread_, options_.cpu));
  if (options_.priority > 0) {
    grants.push_back(ask_for_fifo(thread_, options_.priority));
    fifo_.store(grants.back().granted, std::memory_order_relaxed);
  }
  return grants;
}

std::int64_t RtThread::cpu_ns() const noexcept {
  timespec used{};
  clock_gettime(cpu_clock_, &used);
  return used.tv_sec * kSecondNs + used.tv_nsec;
}

/// By the thread's number and without the C library, whose calls share a lock with the thread.
bool RtThread::demote() noexcept {
  const pid_t tid = tid_.load(std::memory_order_acquire);
  if (tid == 0 || !fifo_.load(std::memory_order_relaxed)) return false;
  const sched_param none{};
  setpriority(PRIO_PROCESS, static_cast<id_t>(tid), kLeast);
  return sched_setscheduler(tid, SCHED_OTHER, &none) == 0;
}

bool RtThread::promote() noexcept {
  const pid_t tid = tid_.load(std::memory_order_acquire);
  if (tid == 0 || !fifo_.load(std::memory_order_relaxed)) return false;
  setpriority(PRIO_PROCESS, static_cast<id_t>(tid), 0);
  sched_param parameters{};
  parameters.sched_priority = options_.priority;
  return sched_setscheduler(tid, SCHED_FIFO, &parameters) == 0;
}

void* RtThread::entry(void* self) {
  static_cast<RtThread*>(self)->loop();
  return nullptr;
}

void RtThread::wait_until(std::int64_t due_ns) const noexcept {
  const std::int64_t wake_ns = due_ns - options_.spin_ns;
  const timespec at{wake_ns / kSecondNs, wake_ns % kSecondNs};
  while (!stop_.load(std::memory_order_relaxed) &&
         clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr) == EINTR) {
  }
  while (options_.spin_ns > 0 && monotonic_ns() < due_ns && !stop_.load(std::memory_order_relaxed)) {
  }
}

void RtThread::loop() noexcept {
  prefault_stack();
  receive_wake_signal();
  prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL,
        0UL);  // without real-time rights the kernel adds 50 us to each wait
  const std::int64_t period_ns = task_.options().period_ns;
  const std::int64_t start_ns = (monotonic_ns() / period_ns + 1) * period_ns;
  const Schedule schedule(start_ns, task_.options().phase_ns, period_ns);
  tid_.store(gettid(), std::memory_order_release);
  std::uint64_t k = 0;
  while (true) {
    owed_since_ns_.store(schedule.due_ns(k), std::memory_order_relaxed);
    wait_until(schedule.due_ns(k));
    if (stop_.load(std::memory_order_acquire)) break;
    const std::int64_t woken_ns = monotonic_ns();
    owed_since_ns_.store(woken_ns, std::memory_order_relaxed);
    k = task_.run(schedule, k, woken_ns, utc_offset_ns_.load(std::memory_order_relaxed));
  }
  ended_.store(true, std::memory_order_release);
}

bool RtThread::stop(std::int64_t limit_ns) noexcept {
  if (!started_) return true;
  stop_.store(true, std::memory_order_release);
  const std::int64_t until_ns = monotonic_ns() + limit_ns;
  while (!ended_.load(std::memory_order_acquire)) {
    if (monotonic_ns() > until_ns) return false;
    pthread_kill(thread_, kWakeSignal);
    const timespec pause{0, 1'000'000};
    nanosleep(&pause, nullptr);
  }
  pthread_join(thread_, nullptr);
  started_ = false;
  return true;
}

}  // namespace stationd

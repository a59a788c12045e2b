// The thread that drives a task, on the machine's own clock: its grid, its end, its rights.
#include <doctest/doctest.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "scan/error.hpp"
#include "scan/rt_thread.hpp"
#include "tests/scan_fixture.hpp"

namespace stationd {
namespace {

using test::StationRig;

constexpr std::int64_t kEndLimitNs = 20'000'000'000;  // far above what it takes
constexpr int kPatienceMs = 20'000;
constexpr uid_t kNobody = 65534;

/// A station in a task in a thread of its own, and the eventfd that it wakes.
class Rig {
 public:
  explicit Rig(std::int64_t period_ns, RtOptions rt = {})
      : wake_fd(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
        task(options(period_ns), {rig.station.get()}, stopwatch),
        thread(task, with_wake(rt, wake_fd), offset) {}
  ~Rig() {
    thread.stop(kEndLimitNs);
    close(wake_fd);
  }
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  static TaskOptions options(std::int64_t period_ns) {
    TaskOptions made;
    made.name = "rig";
    made.period_ns = period_ns;
    return made;
  }
  static RtOptions with_wake(RtOptions rt, int fd) {
    rt.wake_fd = fd;
    return rt;
  }
  /// Waits for that many wakes; false when none came in time.
  bool wait_for_wakes(std::uint64_t count) {
    std::uint64_t seen = 0;
    while (seen < count) {
      pollfd waiting{wake_fd, POLLIN, 0};
      if (poll(&waiting, 1, kPatienceMs) != 1) return false;
      std::uint64_t more = 0;
      if (read(wake_fd, &more, sizeof more) == sizeof more) seen += more;
    }
    return true;
  }

  StationRig rig;
  MonotonicStopwatch stopwatch;
  std::atomic<std::int64_t> offset{utc_offset_ns()};
  int wake_fd;
  Task task;
  RtThread thread;
};

/// Runs it in a child process; what it returned.
template <class Body> bool in_child(Body body) {
  const pid_t child = fork();
  if (child == 0) _exit(body() ? 0 : 1);
  int status = -1;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// In a child: no rights beyond those of an ordinary user, and these limits at 0.
bool drop_rights(const std::vector<int>& limits) {
  const rlimit none{0, 0};
  bool dropped = true;
  for (const int limit : limits) dropped &= setrlimit(static_cast<__rlimit_resource>(limit), &none) == 0;
  if (geteuid() == 0)
    dropped &= setresgid(kNobody, kNobody, kNobody) == 0 && setresuid(kNobody, kNobody, kNobody) == 0;
  return dropped;
}

bool refused(const std::vector<RtGrant>& grants, const std::string& what, const std::string& remedy) {
  return grants.size() == 1 && grants[0].what == what && !grants[0].granted &&
         grants[0].reason.find(remedy) != std::string::npos;
}

/// Runs 100 scans; how many of them were not in a period of their own, later than the one before. A scan
/// woken before its due time would be in the period of its forerunner.
std::uint64_t crowded_scans(RtOptions rt) {
  constexpr std::int64_t kPeriodNs = 2'000'000;
  Rig r(kPeriodNs, rt);
  std::int64_t last = 0;
  std::uint64_t crowded = 0;
  r.rig.program->on_idle = [&](Cycle& cycle) {
    crowded += cycle.now_ns() / kPeriodNs <= last;
    last = cycle.now_ns() / kPeriodNs;
  };
  CHECK(r.thread.start().empty());
  CHECK(r.thread.running());
  CHECK(r.wait_for_wakes(100));
  CHECK(r.thread.stop(kEndLimitNs));
  CHECK_FALSE(r.thread.running());
  CHECK(r.task.figures().scans.load() >= 100);
  CHECK(r.task.figures().lateness.count() == r.task.figures().scans.load());
  return crowded;
}

TEST_CASE("thread without rights asks for none and keeps to the grid [SCAN-1, SCAN-3]") {
  CHECK(crowded_scans({}) == 0);
}

TEST_CASE("thread that spins to its due time never scans before it [SCAN-10]") {
  RtOptions rt;
  rt.spin_ns = 300'000;
  CHECK(crowded_scans(rt) == 0);
}

TEST_CASE("thread gives the scan UTC by the offset that is kept up to date [PV-3]") {
  Rig r(2'000'000);
  r.offset.store(1'234'567);
  r.thread.start();
  CHECK(r.wait_for_wakes(3));
  CHECK(r.thread.stop(kEndLimitNs));
  const StatusRecord status = r.rig.status();
  CHECK(status.utc_ns - status.time_ns == 1'234'567);
}

TEST_CASE("thread that waits 60 s ends at once, its creator's signals blocked or not [SYS-1]") {
  constexpr std::int64_t kMinuteNs = 60'000'000'000;
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  for (const bool blocked : {false, true}) {
    pthread_sigmask(SIG_SETMASK, nullptr, &before);
    if (blocked) pthread_sigmask(SIG_SETMASK, &all, nullptr);
    Rig r(kMinuteNs);
    r.thread.start();
    CHECK(r.thread.stop(kEndLimitNs));
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }
}

TEST_CASE("thread that was never started or has ended stops without ado") {
  Rig r(2'000'000);
  CHECK(r.thread.stop(0));
  r.thread.start();
  CHECK(r.thread.stop(kEndLimitNs));
  CHECK(r.thread.stop(0));
}

TEST_CASE(
    "thread whose program does not return is left alone at the limit, and ended when it does [SCAN-9]") {
  Rig r(2'000'000);
  std::atomic<bool> entered{false};
  std::atomic<bool> held{true};
  r.rig.program->on_idle = [&](Cycle&) {
    entered.store(true);
    while (held.load()) sched_yield();
  };
  r.thread.start();
  while (!entered.load()) sched_yield();
  CHECK_FALSE(r.thread.stop(50'000'000));
  CHECK(r.thread.running());
  held.store(false);
  CHECK(r.thread.stop(kEndLimitNs));
}

TEST_CASE("thread reports a priority as granted exactly when it has it [SCAN-8]") {
  RtOptions rt;
  rt.priority = 1;
  Rig r(2'000'000, rt);
  int policy = -1;
  r.rig.program->on_idle = [&](Cycle&) {
    sched_param parameters{};
    pthread_getschedparam(pthread_self(), &policy, &parameters);
  };
  const std::vector<RtGrant> grants = r.thread.start();
  CHECK(r.wait_for_wakes(20));
  CHECK(r.thread.stop(kEndLimitNs));
  REQUIRE(grants.size() == 1);
  CHECK(grants[0].what == "SCHED_FIFO 1");
  CHECK(grants[0].granted == (policy == SCHED_FIFO));
  CHECK(grants[0].granted == grants[0].reason.empty());
}

TEST_CASE("thread refused its priority says so with the remedy, and scans all the same [SCAN-8]") {
  CHECK(in_child([] {
    if (!drop_rights({RLIMIT_RTPRIO})) return false;
    RtOptions rt;
    rt.priority = 80;
    Rig r(2'000'000, rt);
    const bool said = refused(r.thread.start(), "SCHED_FIFO 80", "grant CAP_SYS_NICE");
    return said && r.wait_for_wakes(5) && r.thread.stop(kEndLimitNs);
  }));
}

TEST_CASE("thread refused its CPU says so with the remedy, and scans all the same [SCAN-8]") {
  for (const int cpu : {1000, 5000}) {
    RtOptions rt;
    rt.cpu = cpu;
    Rig r(2'000'000, rt);
    CHECK(refused(r.thread.start(), "CPU " + std::to_string(cpu), "choose a CPU"));
    CHECK(r.wait_for_wakes(5));
  }
}

TEST_CASE("thread pinned to a CPU runs there [SCAN-7, SCAN-8]") {
  RtOptions rt;
  rt.cpu = sched_getcpu();
  Rig r(2'000'000, rt);
  int seen = -1;
  r.rig.program->on_idle = [&](Cycle&) { seen = sched_getcpu(); };
  const std::vector<RtGrant> grants = r.thread.start();
  CHECK(r.wait_for_wakes(20));
  CHECK(r.thread.stop(kEndLimitNs));
  REQUIRE(grants.size() == 1);
  CHECK(grants[0].granted);
  CHECK(seen == rt.cpu);
}

TEST_CASE("thread that cannot be had at all is a set-up error that names the task [SCAN-8]") {
  CHECK(in_child([] {
    if (!drop_rights({RLIMIT_NPROC})) return false;
    Rig r(2'000'000);
    try {
      r.thread.start();
      return false;
    } catch (const SetupError& e) {
      return std::string(e.what()).find("no thread for task rig") != std::string::npos;
    }
  }));
}

TEST_CASE("CPUs kept awake: granted where the device can be written, else refused with remedies [SCAN-8]") {
  const CpusAwake granted("/dev/null");
  CHECK(granted.grant().granted);
  const CpusAwake refused("/no/such/device");
  CHECK_FALSE(refused.grant().granted);
  for (const char* word : {"No such file", "/no/such/device", "keep_cpus_awake = false"})
    CHECK(refused.grant().reason.find(word) != std::string::npos);
}

TEST_CASE("memory lock that is refused says so with the remedy [SCAN-8]") {
  CHECK(in_child([] {
    return drop_rights({RLIMIT_MEMLOCK}) && refused({lock_memory()}, "memory lock", "CAP_IPC_LOCK");
  }));
}

}  // namespace
}  // namespace stationd

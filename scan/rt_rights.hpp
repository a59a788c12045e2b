// Real-time rights: what is asked of the kernel, and what it said.
// Owned by the daemon, which tells log and Status.
// Set-up, by a plain thread.
#pragma once

#include <pthread.h>

#include <string>

namespace stationd {

/// What was asked of the kernel and what it said, for log and Status.
struct RtGrant {
  std::string what;  ///< "SCHED_FIFO 80", "memory lock", "CPU 1", ...
  bool granted = false;
  std::string reason;  ///< why refused, and what to do about it
};

/// Gives a thread SCHED_FIFO at that priority; the grant's name is `whose` and the policy.
RtGrant ask_for_fifo(pthread_t thread, int priority, const std::string& whose = "");
/// Pins a thread to one CPU.
RtGrant ask_for_cpu(pthread_t thread, int cpu);
/// Locks all present and future memory. Before threads start.
RtGrant lock_memory();

/// Keeps the CPUs out of sleep states that take long to leave, for as long as it lives (the kernel's PM QoS:
/// Documentation/power/pm_qos_interface).
class CpusAwake {
 public:
  explicit CpusAwake(const char* device = "/dev/cpu_dma_latency");
  ~CpusAwake();
  CpusAwake(const CpusAwake&) = delete;
  CpusAwake& operator=(const CpusAwake&) = delete;
  const RtGrant& grant() const noexcept { return grant_; }

 private:
  int descriptor_;
  RtGrant grant_;
};

}  // namespace stationd

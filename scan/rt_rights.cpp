#include "scan/rt_rights.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>

namespace stationd {
namespace {

RtGrant granted(std::string what) { return {std::move(what), true, ""}; }

RtGrant refused(std::string what, int error, const std::string& remedy) {
  return {std::move(what), false, std::string(std::strerror(error)) + ": " + remedy};
}

}  // namespace

RtGrant ask_for_fifo(pthread_t thread, int priority, const std::string& whose) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int error = pthread_setschedparam(thread, SCHED_FIFO, &parameters);
  std::string what = whose + "SCHED_FIFO " + std::to_string(priority);
  if (error == 0) return granted(std::move(what));
  return refused(std::move(what), error,
                 "grant CAP_SYS_NICE or raise the rtprio limit (systemd: LimitRTPRIO=)");
}

RtGrant ask_for_cpu(pthread_t thread, int cpu) {
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  CPU_SET(static_cast<std::size_t>(cpu), &cpus);
  const int error = pthread_setaffinity_np(thread, sizeof cpus, &cpus);
  std::string what = "CPU " + std::to_string(cpu);
  if (error == 0) return granted(std::move(what));
  return refused(std::move(what), error, "choose a CPU that this machine has and allows");
}

RtGrant lock_memory() {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return granted("memory lock");
  return refused("memory lock", errno,
                 "grant CAP_IPC_LOCK or raise the memlock limit (systemd: LimitMEMLOCK=)");
}

CpusAwake::CpusAwake(const char* device) : descriptor_(open(device, O_WRONLY | O_CLOEXEC)) {
  const std::int32_t latency_us = 0;
  if (descriptor_ >= 0 && write(descriptor_, &latency_us, sizeof latency_us) == sizeof latency_us) {
    grant_ = granted("CPUs awake");
    return;
  }
  grant_ = refused("CPUs awake", errno,
                   "let this user write " + std::string(device) +
                       " (systemd/60-stationd.rules), or set [controller] keep_cpus_awake = false");
}

CpusAwake::~CpusAwake() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace stationd

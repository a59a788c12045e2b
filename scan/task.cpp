#include "scan/task.hpp"

#include "scan/codes.hpp"

namespace stationd {
namespace {

void bump(std::atomic<std::uint64_t>& counter, std::uint64_t by) noexcept {
  counter.store(counter.load(std::memory_order_relaxed) + by, std::memory_order_relaxed);
}

}  // namespace

Task::Task(TaskOptions options, std::vector<Station*> stations, Stopwatch& stopwatch)
    : options_(std::move(options)), stations_(std::move(stations)), stopwatch_(stopwatch) {}

std::uint64_t Task::run(const Schedule& schedule, std::uint64_t k, std::int64_t woken_ns,
                        std::int64_t utc_offset_ns) noexcept {
  const std::int64_t due_ns = schedule.due_ns(k);
  const std::int64_t next_due_ns = schedule.due_ns(k + 1);
  ++scan_;
  for (Station* s : stations_) s->begin(woken_ns, scan_, utc_offset_ns);
  for (Station* s : stations_) s->latch();
  const std::int64_t latched_ns = stopwatch_.now_ns();
  for (Station* s : stations_) s->execute();
  const std::int64_t executed_ns = stopwatch_.now_ns();
  for (Station* s : stations_) s->commit();
  const std::int64_t committed_ns = stopwatch_.now_ns();
  const std::uint64_t misses = figures_.deadline_misses.load(std::memory_order_relaxed);
  for (Station* s : stations_) s->publish(misses);
  const std::int64_t published_ns = stopwatch_.now_ns();
  wake();
  if (service(next_due_ns) != 0) wake();
  const std::int64_t serviced_ns = stopwatch_.now_ns();

  const std::uint64_t next = schedule.next(k, serviced_ns);
  CycleRecord record{scan_,
                     woken_ns - due_ns,
                     latched_ns - woken_ns,
                     executed_ns - latched_ns,
                     committed_ns - executed_ns,
                     published_ns - committed_ns,
                     serviced_ns - published_ns,
                     committed_ns - due_ns,
                     next - k - 1,
                     committed_ns > next_due_ns};
  account(record);
  return next;
}

std::uint64_t Task::service(std::int64_t next_due_ns) noexcept {
  std::uint64_t serviced = 0;
  bool any = true;
  for (int round = 0; any && round < kServicePerScan; ++round) {
    any = false;
    for (Station* s : stations_) {
      if (stopwatch_.now_ns() + kServiceReserveNs >= next_due_ns) return serviced;
      if (!s->service_one()) continue;
      any = true;
      ++serviced;
    }
  }
  return serviced;
}

void Task::account(CycleRecord& record) noexcept {
  figures_.lateness.record(record.lateness_ns);
  figures_.execution.record(record.latch_ns + record.execute_ns + record.commit_ns);
  figures_.response.record(record.response_ns);
  bump(figures_.scans, 1);
  const std::uint64_t missed = record.skipped + (record.committed_late ? 1 : 0);
  if (missed == 0) return;
  misses_.push(record);  // before the counter: who sees the count finds the record
  bump(figures_.skipped, record.skipped);
  figures_.deadline_misses.store(figures_.deadline_misses.load(std::memory_order_relaxed) + missed,
                                 std::memory_order_release);
  if (options_.overrun != OverrunPolicy::fault) return;
  for (Station* s : stations_) s->fault(code::overrun, static_cast<std::int64_t>(record.scan));
  wake();
}

}  // namespace stationd

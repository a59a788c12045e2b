#include "scan/task.hpp"

#include "scan/codes.hpp"

namespace stationd {
namespace {

void bump(std::atomic<std::uint64_t>& counter, std::uint64_t by) noexcept {
  counter.store(counter.load(std::memory_order_relaxed) + by, std::memory_order_relaxed);
}

}  // namespace

std::string_view name_of(Phase phase) noexcept {
  static constexpr std::array<std::string_view, kPhases> names = {"latch", "execute", "commit", "publish",
                                                                  "service"};
  return names[static_cast<std::size_t>(phase)];
}

Task::Task(TaskOptions options, std::vector<Station*> stations, Stopwatch& stopwatch)
    : options_(std::move(options)), stations_(std::move(stations)), stopwatch_(stopwatch) {
  if (stations_.size() < 2) return;
  shares_.resize(stations_.size());
  for (Share& share : shares_) share.figures = std::make_unique<StationFigures>();
}

/// One phase of every station; several are told apart by a stamp behind each. Returns when it ended.
template <class Work> std::int64_t Task::each(std::int64_t since_ns, Work work) noexcept {
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    work(*stations_[i]);
    if (shares_.empty()) break;
    shares_[i].done_ns = stopwatch_.now_ns();
    shares_[i].spent_ns += shares_[i].done_ns - since_ns;
    since_ns = shares_[i].done_ns;
  }
  return shares_.empty() ? stopwatch_.now_ns() : since_ns;
}

std::uint64_t Task::run(const Schedule& schedule, std::uint64_t k, std::int64_t woken_ns,
                        std::int64_t utc_offset_ns) noexcept {
  const std::int64_t due_ns = schedule.due_ns(k);
  const std::int64_t next_due_ns = schedule.due_ns(k + 1);
  ++scan_;
  for (Station* s : stations_) s->begin(woken_ns, scan_, utc_offset_ns);
  for (Share& share : shares_) share.spent_ns = 0;
  const std::int64_t latched_ns = each(woken_ns, [](Station& s) noexcept { s.latch(); });
  const std::int64_t executed_ns = each(latched_ns, [](Station& s) noexcept { s.execute(); });
  const std::int64_t committed_ns = each(executed_ns, [](Station& s) noexcept { s.commit(); });
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
  account_shares(record, due_ns);
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

void Task::account_shares(CycleRecord& record, std::int64_t due_ns) noexcept {
  if (shares_.empty()) record.slowest_ns = record.latch_ns + record.execute_ns + record.commit_ns;
  for (std::size_t i = 0; i < shares_.size(); ++i) {
    const Share& share = shares_[i];
    share.figures->execution.record(share.spent_ns);
    share.figures->response.record(share.done_ns - due_ns);
    if (share.spent_ns <= record.slowest_ns) continue;
    record.slowest = static_cast<std::uint32_t>(i);
    record.slowest_ns = share.spent_ns;
  }
}

void Task::account(const CycleRecord& record) noexcept {
  figures_.lateness.record(record.lateness_ns);
  figures_.execution.record(record.latch_ns + record.execute_ns + record.commit_ns);
  figures_.response.record(record.response_ns);
  const std::array<std::int64_t, kPhases> phases_ns = {record.latch_ns, record.execute_ns, record.commit_ns,
                                                       record.publish_ns, record.service_ns};
  for (std::size_t i = 0; i < kPhases; ++i) figures_.phases[i].record(phases_ns[i]);
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

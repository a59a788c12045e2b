#include "scan/statistics.hpp"

#include <algorithm>
#include <utility>

namespace stationd {
namespace {

constexpr std::size_t kOfTask = 3 + kPhases;  // readers before those of the stations

/// The value of rank ceil(count * permille / 1000), at least the first, told by the middle of its bucket.
std::int64_t quantile_ns(const std::vector<BucketCount>& buckets, const Summary& of, std::uint64_t permille) {
  const std::uint64_t rank = std::max<std::uint64_t>((of.count * permille + 999) / 1000, 1);
  std::uint64_t seen = 0;
  for (const BucketCount& b : buckets) {
    seen += b.count;
    if (seen < rank) continue;
    return b.bucket == Buckets::kOverflow ? of.max_ns
                                          : std::clamp(Buckets::middle_ns(b.bucket), of.min_ns, of.max_ns);
  }
  return of.max_ns;
}

}  // namespace

void CounterReader::collect(std::uint64_t value, std::int64_t now_ns) {
  minute_.at(now_ns) += value - value_;
  value_ = value;
}

std::uint64_t CounterReader::value(Window window) const noexcept {
  if (window == Window::since_start) return value_;
  std::uint64_t sum = 0;
  for (const std::uint64_t part : minute_.parts()) sum += part;
  return sum;
}

void HistogramReader::Part::add(std::size_t bucket, std::uint32_t count) {
  const auto at = std::ranges::lower_bound(some, bucket, {}, &Some::bucket);
  if (at != some.end() && at->bucket == bucket)
    at->count += count;
  else
    some.insert(at, {static_cast<std::uint16_t>(bucket), count});
}

void HistogramReader::cover(std::size_t first, std::size_t last) {
  if (totals_.empty()) first_ = first;
  const std::size_t from = std::min(first, first_), end = std::max(last + 1, first_ + totals_.size());
  if (end - from == totals_.size()) return;
  std::vector<std::uint64_t> wider(end - from);
  std::ranges::copy(totals_, wider.begin() + static_cast<std::ptrdiff_t>(first_ - from));
  totals_ = std::move(wider);
  first_ = from;
}

void HistogramReader::collect(std::int64_t now_ns) {
  Histogram::Reading now;
  source_->read(now);  // should records not pause, all but the mean is still right
  take(now, now_ns);
}

void HistogramReader::take(const Histogram::Reading& now, std::int64_t now_ns) {
  Part& part = minute_.at(now_ns);
  if (now.count == 0) return;
  cover(now.first, now.last);
  for (std::size_t i = now.first; i <= now.last; ++i) {
    std::uint64_t& total = totals_[i - first_];
    const std::uint32_t fresh = now.buckets[i] - static_cast<std::uint32_t>(total);
    if (fresh == 0) continue;
    total += fresh;
    part.add(i, fresh);
  }
  part.some.shrink_to_fit();  // memory is locked: what is not needed is not kept
  part.sum_ns += now.sum_ns - sum_ns_;
  sum_ns_ = now.sum_ns;
  min_ns_ = now.min_ns;
  max_ns_ = now.max_ns;
}

std::vector<BucketCount> HistogramReader::buckets(Window window) const {
  std::vector<std::uint64_t> counts(totals_);
  if (window == Window::last_minute) {
    std::ranges::fill(counts, 0);
    for (const Part& part : minute_.parts())
      for (const Some& s : part.some) counts[s.bucket - first_] += s.count;
  }
  std::vector<BucketCount> list;
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] != 0) list.push_back({first_ + i, counts[i]});
  return list;
}

Summary HistogramReader::summary(Window window) const {
  Summary s;
  const std::vector<BucketCount> list = buckets(window);
  if (list.empty()) return s;
  for (const BucketCount& b : list) s.count += b.count;
  s.min_ns = min_ns_;
  s.max_ns = max_ns_;
  std::uint64_t sum_ns = sum_ns_;
  if (window == Window::last_minute) {
    sum_ns = 0;
    for (const Part& part : minute_.parts()) sum_ns += part.sum_ns;
    s.min_ns = std::clamp(Buckets::middle_ns(list.front().bucket), min_ns_, max_ns_);
    if (list.back().bucket != Buckets::kOverflow)
      s.max_ns = std::clamp(Buckets::middle_ns(list.back().bucket), min_ns_, max_ns_);
  }
  s.mean_ns = std::clamp(static_cast<std::int64_t>(sum_ns / s.count), s.min_ns, s.max_ns);
  s.p50_ns = quantile_ns(list, s, 500);
  s.p99_ns = quantile_ns(list, s, 990);
  s.p999_ns = quantile_ns(list, s, 999);
  return s;
}

TaskStatistics::TaskStatistics(const Task& task) : task_(task) {
  const TaskFigures& f = task.figures();
  for (const Histogram* h : {&f.lateness, &f.execution, &f.response}) readers_.emplace_back(*h);
  for (const Histogram& phase : f.phases) readers_.emplace_back(phase);
  if (task.stations().size() < 2) return;
  for (std::size_t i = 0; i < task.stations().size(); ++i) {
    readers_.emplace_back(task.execution_of(i));
    readers_.emplace_back(task.response_of(i));
  }
}

void TaskStatistics::collect(std::int64_t now_ns) {
  const TaskFigures& f = task_.figures();
  scans_.collect(f.scans.load(std::memory_order_relaxed), now_ns);
  misses_.collect(f.deadline_misses.load(std::memory_order_relaxed), now_ns);
  skipped_.collect(f.skipped.load(std::memory_order_relaxed), now_ns);
  for (HistogramReader& reader : readers_) reader.collect(now_ns);
}

const HistogramReader& TaskStatistics::figure(std::size_t place, Figure figure) const {
  const bool alone = readers_.size() == kOfTask;
  const auto number = static_cast<std::size_t>(figure);
  switch (figure) {
    case Figure::lateness: return readers_[0];
    case Figure::execution: return readers_[alone ? 1 : kOfTask + 2 * place];
    case Figure::response: return readers_[alone ? 2 : kOfTask + 2 * place + 1];
    case Figure::task_execution: return readers_[1];
    case Figure::task_response: return readers_[2];
    default: return readers_[3 + number - static_cast<std::size_t>(Figure::latch)];
  }
}

}  // namespace stationd

// bench_requester: asks each station of a cell in turn for its status, 100 times a second, and hands out what
// the daemon counted.
// Run by bench/scan_lateness, which writes one line a question and reads one line of JSON for each:
//   window    waits for the next statistics; totals since start: scans, misses, lateness by bucket
//   states    the state of each station, by name
#include <poll.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "dds_bridge/bus.hpp"
#include "dds_bridge/histogram_body.hpp"
#include "scan/clock.hpp"

namespace stationd::bench {
namespace {

constexpr auto kStations = std::to_array<const char*>({"loader", "robot", "sealer", "storage"});
constexpr const char* kAsked = "robot";  // all are of one task, whose lateness is asked for
constexpr std::int64_t kEveryNs = 10'000'000;
constexpr std::int64_t kLimitNs = 10'000'000'000;
/// Steal is counted in hundredths of a second and Status comes ten times a second.
constexpr std::int64_t kTogetherNs = 200'000'000;
constexpr std::size_t kMaxBody = 65536;

/// Time that the host took from one CPU (or all), in ticks.
std::uint64_t steal_ticks(const std::string& cpu) {
  std::ifstream file("/proc/stat");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    if (name != cpu) continue;
    std::uint64_t value = 0;
    for (int i = 0; i < 8; ++i) words >> value;
    return value;
  }
  return 0;
}

class Requester {
 public:
  Requester(const bus::Options& options, std::string cpu)
      : name_(options.name), cpu_(std::move(cpu)), bus_(options) {
    bus::Handlers handlers;
    handlers.names = {name_};
    handlers.on_status = [this](const bus::Status& s, const bus::Origin&) { take(s); };
    handlers.on_stats = [this](const bus::ScanStats& s, const bus::Origin&) { take(s); };
    handlers.on_reply = [this](const bus::MsgRes& r, const bus::Origin&, const bus::Origin&) { take(r); };
    bus_.prepare_writers({"Msg_Req"});
    bus_.start(std::move(handlers));
  }
  ~Requester() {
    end_.store(true);
    if (thread_.joinable()) thread_.join();
    bus_.stop();
  }
  Requester(const Requester&) = delete;
  Requester& operator=(const Requester&) = delete;

  void start() {
    thread_ = std::thread([this] { ask_in_turn(); });
  }

  std::string window() {
    std::unique_lock lock(mutex_);
    stats_.reset();
    histogram_.reset();
    if (!wait(lock, [this] { return stats_.has_value(); })) return R"({"error": "no statistics"})";
    const bus::ScanStats stats = *stats_;
    lock.unlock();
    write(kAsked, "histogram lateness");
    lock.lock();
    if (!wait(lock, [this] { return histogram_.has_value(); })) return R"({"error": "no histogram"})";
    return text_of(stats, *histogram_);
  }

  std::string states() {
    const std::lock_guard lock(mutex_);
    std::string text;
    for (const auto& [name, state] : states_)
      text += (text.empty() ? "\"" : ", \"") + name + "\": " + std::to_string(state);
    return "{" + text + "}";
  }

 private:
  bool wait(std::unique_lock<std::mutex>& lock, const std::function<bool()>& holds) {
    return changed_.wait_for(lock, std::chrono::nanoseconds(kLimitNs), holds);
  }

  void write(const std::string& station, const std::string& verb) {
    bus_.write_request({station, verb + " from=" + name_ + " id=" + std::to_string(sent_), bus::Order::MSG});
    ++sent_;
  }

  void ask_in_turn() {
    std::int64_t due_ns = monotonic_ns();
    for (std::size_t i = 0; !end_.load(); ++i) {
      write(kStations.at(i % kStations.size()), "status");
      watch_steal();
      due_ns += kEveryNs;
      std::this_thread::sleep_for(std::chrono::nanoseconds(due_ns - monotonic_ns()));
    }
  }

  void watch_steal() {
    const std::uint64_t ticks = steal_ticks(cpu_);
    const std::lock_guard lock(mutex_);
    if (ticks != steal_) stolen_ns_ = monotonic_ns();
    steal_ = ticks;
    if (pending_ == 0 || monotonic_ns() - missed_ns_ < kTogetherNs) return;
    judge();
  }

  /// Misses are told apart when steal that belongs to them has had the time to be counted.
  void judge() {
    if (stolen_ns_ >= missed_ns_ - kTogetherNs && stolen_ns_ != 0) beside_steal_ += pending_;
    pending_ = 0;
  }

  void take(const bus::Status& status) {
    const std::lock_guard lock(mutex_);
    states_[status.STATION] = status.STATE;
    if (status.STATION != kAsked) return;
    if (heard_ && status.DEADLINE_MISSES > misses_) {
      if (pending_ == 0) missed_ns_ = monotonic_ns();
      pending_ += status.DEADLINE_MISSES - misses_;
    }
    heard_ = true;
    misses_ = status.DEADLINE_MISSES;
  }

  void take(const bus::ScanStats& stats) {
    if (stats.STATION != kAsked) return;
    const std::lock_guard lock(mutex_);
    stats_ = stats;
    changed_.notify_all();
  }

  void take(const bus::MsgRes& reply) {
    const std::lock_guard lock(mutex_);
    ++answered_;
    const std::size_t blank = reply.BODY.find(' ');
    if (blank == std::string::npos) return;
    auto histogram = bus::parse_histogram(std::string_view(reply.BODY).substr(blank + 1));
    if (!histogram) return;
    histogram_ = std::move(*histogram);
    changed_.notify_all();
  }

  std::string text_of(const bus::ScanStats& stats, const bus::HistogramBody& histogram) const {
    std::ostringstream text;
    const Summary& execution = stats.FIGURES[0][static_cast<std::size_t>(
        stats.TASK_STATIONS > 1 ? Figure::task_execution : Figure::execution)];
    text << R"({"scans": )" << stats.SCANS << R"(, "misses": )" << stats.DEADLINE_MISSES << R"(, "skipped": )"
         << stats.SKIPPED << R"(, "execution_p50_ns": )" << execution.p50_ns << R"(, "execution_p99_ns": )"
         << execution.p99_ns << R"(, "lateness_max_ns": )"
         << stats.FIGURES[0][static_cast<std::size_t>(Figure::lateness)].max_ns << R"(, "sent": )" << sent_
         << R"(, "answered": )" << answered_ << R"(, "misses_beside_steal": )" << beside_steal_
         << R"(, "merged": )" << histogram.merged << R"(, "buckets": [)";
    const char* comma = "";
    for (const BucketCount& b : histogram.buckets) {
      text << comma << "[" << histogram.low_ns(b.bucket) << ", " << histogram.end_ns(b.bucket) << ", "
           << b.count << "]";
      comma = ", ";
    }
    text << "]}";
    return text.str();
  }

  const std::string name_, cpu_;
  std::atomic<bool> end_{false};
  std::atomic<std::uint64_t> sent_{0};
  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::map<std::string, std::uint32_t> states_;
  std::optional<bus::ScanStats> stats_;
  std::optional<bus::HistogramBody> histogram_;
  std::uint64_t answered_ = 0, misses_ = 0, pending_ = 0, beside_steal_ = 0, steal_ = 0;
  std::int64_t missed_ns_ = 0, stolen_ns_ = 0;
  bool heard_ = false;
  bus::Bus bus_;
  std::thread thread_;
};

int run(int domain, const std::string& cell, const std::string& cpu) {
  bus::Options options;
  options.domain = domain;
  options.cell = cell;
  options.name = "requester";
  options.max_body_bytes = kMaxBody;
  Requester requester(options, cpu);
  requester.start();
  for (std::string line; std::getline(std::cin, line);)
    std::cout << (line == "window" ? requester.window() : requester.states()) << std::endl;
  return 0;
}

}  // namespace
}  // namespace stationd::bench

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: bench_requester DOMAIN CELL CPU, CPU as in /proc/stat: cpu1\n");
    return 2;
  }
  try {
    return stationd::bench::run(std::atoi(argv[1]), argv[2], argv[3]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_requester: %s\n", e.what());
    return 1;
  }
}

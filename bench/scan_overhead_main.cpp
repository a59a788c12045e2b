// bench_scan_overhead: what one cycle of the engine costs, by phase, for a number of tags, devices, stations.
// Run by bench/scan_overhead. One line of JSON on stdout.
#include <pthread.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "scan/clock.hpp"
#include "scan/cycle.hpp"
#include "scan/rt_thread.hpp"
#include "scan/statistics.hpp"

namespace stationd::bench {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kStaleNs = 10'000'000'000, kBadNs = 60'000'000'000;
constexpr std::size_t kWarmUp = 50;
constexpr int kPriority = 80;
constexpr std::uint64_t kEnd = 1ULL << 32;

struct Shape {
  std::size_t tags = 1000;  // of all stations together
  std::size_t devices = 2, stations = 1, groups = 4;
  std::size_t cycles = 2000;
  bool pause = false;  // to the next millisecond, asleep
};

/// Does nothing with its tags: two fifths inputs, two fifths outputs, the rest is published in PV groups.
class EmptyProgram final : public Program {
 public:
  EmptyProgram(std::size_t tags, std::size_t groups) {
    const std::size_t each = tags * 2 / 5;
    for (std::size_t i = 0; i < each; ++i) add(inputs_, input_names, "in", i);
    for (std::size_t i = 0; i < each; ++i) add(outputs_, output_names, "out", i);
    std::vector<std::vector<PvMember>> members(groups);
    for (std::size_t i = 0; i < tags - 2 * each; ++i) {
      add(variables_, variable_names, "var", i);
      if (groups > 0) members[i % groups].push_back({variable_names.back(), variables_.back().get()});
    }
    for (std::size_t g = 0; g < groups; ++g) publish("Group" + std::to_string(g), std::move(members[g]));
  }
  void execute(Cycle&) noexcept override {}

  std::vector<std::string> input_names, output_names, variable_names;

 private:
  template <class T>
  void add(std::vector<std::unique_ptr<T>>& to, std::vector<std::string>& names, const char* kind,
           std::size_t number) {
    names.push_back(kind + std::to_string(number));
    to.push_back(std::make_unique<T>(*this, names.back(), "a tag"));
  }
  std::vector<std::unique_ptr<In<std::int32_t>>> inputs_;
  std::vector<std::unique_ptr<Out<std::int32_t>>> outputs_;
  std::vector<std::unique_ptr<Var<std::int32_t>>> variables_;
};

/// Part `at` of `parts` of the names.
std::vector<std::string> part_of(const std::vector<std::string>& names, std::size_t at, std::size_t parts) {
  const auto begin = names.begin();
  return {begin + static_cast<std::ptrdiff_t>(names.size() * at / parts),
          begin + static_cast<std::ptrdiff_t>(names.size() * (at + 1) / parts)};
}

std::unique_ptr<Station> make_station(const Shape& shape, std::size_t number) {
  StationOptions options;
  options.name = "s" + std::to_string(number);
  auto made = std::make_unique<EmptyProgram>(shape.tags / shape.stations, shape.groups);
  EmptyProgram& program = *made;
  auto station = std::make_unique<Station>(options, std::move(made));
  const std::size_t links = std::max<std::size_t>(shape.devices / shape.stations, 1);
  for (std::size_t i = 0; i < links; ++i) {
    const std::string device = "d" + std::to_string((number * links + i) % shape.devices);
    station->add_device_inputs(device, part_of(program.input_names, i, links), kStaleNs, kBadNs);
    station->add_device_outputs(device, part_of(program.output_names, i, links));
  }
  station->seal();
  return station;
}

/// What the devices' threads do meanwhile, outside the measured time: new values for every input.
void feed(Station& station, std::int64_t now_ns, std::uint64_t count) {
  for (const auto& link : station.device_inputs()) {
    const BlockView block{link->blocks.writable(), link->tags.layout};
    std::ranges::fill(block.slots(), count);
    std::ranges::fill(block.qualities(), Quality::GOOD);
    block.header() = {now_ns, 0, 0, count, Quality::GOOD};
    link->blocks.publish();
  }
}

/// The bus-out thread's part: it is asleep on the eventfd and is woken in each cycle. kEnd ends it.
void drain(int descriptor) {
  std::uint64_t value = 0;
  while (::read(descriptor, &value, sizeof value) == sizeof value && value < kEnd) {
  }
}

void sleep_to_next_ms() {
  const std::int64_t at_ns = (monotonic_ns() / kMs + 1) * kMs;
  const timespec at{at_ns / 1'000'000'000, at_ns % 1'000'000'000};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
}

long resident_kb() {
  long pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%*d %ld", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return pages * (sysconf(_SC_PAGESIZE) / 1024);
}

void print_figure(const char* name, const Histogram& histogram) {
  HistogramReader reader(histogram);
  reader.collect(0);
  const Summary is = reader.summary(Window::since_start);
  std::printf(", \"%s\": {\"mean_ns\": %lld, \"p50_ns\": %lld, \"p99_ns\": %lld}", name,
              static_cast<long long>(is.mean_ns), static_cast<long long>(is.p50_ns),
              static_cast<long long>(is.p99_ns));
}

/// A cycle as RtThread runs it, but for the wait. Its cost ends when run() has returned: accounts included.
class Loop {
 public:
  explicit Loop(const Shape& shape)
      : shape_(shape), descriptor_(eventfd(0, EFD_CLOEXEC)), waker_(descriptor_) {
    for (std::size_t i = 0; i < shape.stations; ++i) stations_.push_back(make_station(shape, i));
    reader_ = std::thread(drain, descriptor_);
  }
  ~Loop() {
    const std::uint64_t end = kEnd;
    if (::write(descriptor_, &end, sizeof end) != sizeof end) std::abort();
    reader_.join();
    ::close(descriptor_);
  }
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  void run(Task& task, std::size_t cycles, Histogram& whole) {
    task.set_waker(&waker_);
    for (std::size_t i = 0; i < cycles; ++i) {
      ++count_;
      for (const auto& station : stations_) feed(*station, monotonic_ns(), count_);
      if (shape_.pause) sleep_to_next_ms();
      const std::int64_t woken_ns = monotonic_ns();
      task.run(Schedule(woken_ns, 0, 1000 * kMs), 0, woken_ns, 0);
      whole.record(monotonic_ns() - woken_ns);
    }
  }
  std::vector<Station*> stations() const {
    std::vector<Station*> all;
    for (const auto& station : stations_) all.push_back(station.get());
    return all;
  }

 private:
  const Shape shape_;
  std::vector<std::unique_ptr<Station>> stations_;
  int descriptor_;
  EventfdWaker waker_;
  std::thread reader_;
  std::uint64_t count_ = 0;
};

void measure(const Shape& shape) {
  const long before_kb = resident_kb();
  Loop loop(shape);
  const long after_kb = resident_kb();
  MonotonicStopwatch stopwatch;
  const bool locked = lock_memory().granted;
  const bool fifo = ask_for_fifo(pthread_self(), kPriority).granted;
  const auto whole = std::make_unique<Histogram>();
  {
    const auto warm_up = std::make_unique<Task>(TaskOptions{}, loop.stations(), stopwatch);
    loop.run(*warm_up, kWarmUp, *std::make_unique<Histogram>());
  }
  const auto task = std::make_unique<Task>(TaskOptions{}, loop.stations(), stopwatch);
  loop.run(*task, shape.cycles, *whole);
  std::printf("{\"tags\": %zu, \"devices\": %zu, \"stations\": %zu, \"groups\": %zu, \"pause\": %s",
              shape.tags, shape.devices, shape.stations, shape.groups, shape.pause ? "true" : "false");
  std::printf(", \"realtime\": %s, \"engine_kb\": %ld", locked && fifo ? "true" : "false",
              after_kb - before_kb);
  print_figure("cycle", *whole);
  for (std::size_t i = 0; i < kPhases; ++i)
    print_figure(std::string(name_of(static_cast<Phase>(i))).c_str(), task->figures().phases[i]);
  std::printf("}\n");
}

std::size_t number(const char* text) {
  char* end = nullptr;
  const unsigned long long value = std::strtoull(text, &end, 10);
  if (*text == '\0' || *end != '\0') throw std::invalid_argument(std::string("not a number: ") + text);
  return value;
}

Shape shape_of(int argc, char** argv) {
  Shape shape;
  const std::map<std::string, std::size_t*> numbers = {{"--tags", &shape.tags},
                                                       {"--devices", &shape.devices},
                                                       {"--stations", &shape.stations},
                                                       {"--groups", &shape.groups},
                                                       {"--cycles", &shape.cycles}};
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto it = numbers.find(argument);
    if (it != numbers.end() && i + 1 < argc)
      *it->second = number(argv[++i]);
    else if (argument == "--pause")
      shape.pause = true;
    else
      throw std::invalid_argument("unknown argument " + argument);
  }
  if (shape.stations == 0 || shape.devices == 0 || shape.tags < shape.stations)
    throw std::invalid_argument("at least one station, one device, and a tag for each station");
  return shape;
}

}  // namespace
}  // namespace stationd::bench

int main(int argc, char** argv) {
  try {
    stationd::bench::measure(stationd::bench::shape_of(argc, argv));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_scan_overhead: %s\n", e.what());
    return 2;
  }
  return 0;
}

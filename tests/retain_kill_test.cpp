// A process that retains tags is killed (kill -9) again and again: what it leaves is whole, of one scan,
// recent.
#include <doctest/doctest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "daemon/retain_thread.hpp"
#include "scan/cycle.hpp"
#include "scan/program.hpp"
#include "scan/rt_thread.hpp"
#include "scan/station.hpp"

namespace stationd {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kIntervalNs = 50 * kMs;
constexpr std::int64_t kGenerousNs = 1'000 * kMs;  // for a busy machine; longer lives than this show the age
constexpr std::size_t kTags = 64;
constexpr int kMismatch = 3;

/// All its retained tags say how many scans there were, over all its lives.
class Counting final : public Program {
 public:
  Counting() {
    for (std::size_t i = 0; i < kTags; ++i)
      tags_.push_back(std::make_unique<Retained<std::uint32_t>>(*this, "count" + std::to_string(i), ""));
  }
  void execute(Cycle& cycle) noexcept override {
    const std::uint32_t next = count() + 1;
    for (auto& tag : tags_) *tag = next;
    if (next % 97 == 0) cycle.save_retained();
  }
  std::uint32_t count() const noexcept { return tags_[0]->get(); }

 private:
  std::vector<std::unique_ptr<Retained<std::uint32_t>>> tags_;
};

/// What the process tells whoever outlives it.
struct Witness {
  static constexpr std::uint32_t kMost = 1'000'000;
  std::atomic<std::uint32_t> count;
  std::atomic<std::int64_t> made_ns[kMost];  // when each count was
};

Witness& shared_witness() {
  void* memory = mmap(nullptr, sizeof(Witness), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  REQUIRE(memory != MAP_FAILED);
  return *static_cast<Witness*>(memory);
}

/// The program's own; the station's, whether it was running, is the last.
bool all_alike(const std::vector<Slot>& slots) {
  return slots.size() == kTags + 1 && std::count(slots.begin(), slots.end() - 1, slots[0]) == kTags;
}

RetainStore store_of(const fs::path& directory) { return {directory, "C", "ST", 0x1234}; }

/// One life: restores, scans, saves, until it is killed.
[[noreturn]] void live(const fs::path& directory, Witness& witness) {
  auto store = std::make_unique<RetainStore>(directory, "C", "ST", 0x1234);
  const RetainStore::Loaded loaded = store->load();
  if (loaded.record && !all_alike(loaded.record->slots)) _exit(kMismatch);
  auto program = std::make_unique<Counting>();
  const Counting& counting = *program;
  Station station({.name = "ST"}, std::move(program));
  station.seal();
  station.set_epoch(loaded.epoch + 1);
  if (loaded.record) station.restore(loaded.record->slots);
  RetainThread thread([](int, const std::string&) {}, kIntervalNs);
  thread.add(station, std::move(store));
  thread.start();
  Request start;
  start.verb = Verb::start;
  start.order = 1;
  station.port().requests.push(start);
  for (std::uint64_t scan = 1; counting.count() + 1 < Witness::kMost; ++scan) {
    station.begin(monotonic_ns(), scan, 0);
    station.latch();
    station.execute();
    const std::uint32_t count = counting.count();
    if (count > 0) witness.made_ns[count] = monotonic_ns();
    witness.count = count;
    station.commit();
    station.publish(0);
    station.service_one();
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  _exit(0);
}

}  // namespace

TEST_CASE("Process that is killed again and again leaves retained tags whole, of one scan, recent (IMG-4)") {
  std::string name = (fs::temp_directory_path() / "stationd-killed-XXXXXX").string();
  REQUIRE(mkdtemp(name.data()) != nullptr);
  const fs::path directory = name;
  Witness& witness = shared_witness();
  std::mt19937_64 random(7);
  Slot before = 0;
  for (int kill_number = 0; kill_number < 36; ++kill_number) {
    CAPTURE(kill_number);
    const pid_t child = fork();
    if (child == 0) live(directory, witness);
    // Mostly a short life; now and then one that is longer than what the age is held to.
    const auto life_ms = kill_number % 9 == 8 ? 2'000 : 1 + random() % 150;
    std::this_thread::sleep_for(std::chrono::milliseconds(life_ms));
    const std::int64_t killed_ns = monotonic_ns();
    REQUIRE(kill(child, SIGKILL) == 0);
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    REQUIRE(WIFSIGNALED(status));  // and did not end by itself over a mixed record
    const RetainStore::Loaded loaded = store_of(directory).load();
    if (!loaded.record) {
      CHECK(before == 0);  // it was killed before it had saved for the first time
      continue;
    }
    REQUIRE(all_alike(loaded.record->slots));
    const Slot count = loaded.record->slots[0];
    CHECK(count >= before);
    CHECK(count <= witness.count);
    before = count;
    // The oldest change that was not saved.
    if (count < witness.count) CHECK(killed_ns - witness.made_ns[count + 1] < kIntervalNs + kGenerousNs);
  }
  CHECK(before > 1'000);
  munmap(&witness, sizeof(Witness));
  fs::remove_all(directory);
}

}  // namespace stationd

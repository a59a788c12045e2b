// The retain thread's looks, at times that the test says, into a store of the test's own.
#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "daemon/retain_thread.hpp"
#include "tests/scan_fixture.hpp"

namespace stationd::test {
namespace {

constexpr std::int64_t kIntervalNs = 1'000 * kMs;

/// What was saved, as the test sees it after the thread's object owns the store.
struct Disk {
  std::vector<Slot> saved;  // the first slot of each save
  std::uint32_t epoch = 0;
  bool full = false;
};

class FakeStore final : public RetainTarget {
 public:
  explicit FakeStore(Disk& disk) : disk_(disk) {}
  bool save(std::uint32_t epoch, std::span<const Slot> slots) override {
    if (disk_.full) return false;
    disk_.epoch = epoch;
    disk_.saved.push_back(slots[0]);
    return true;
  }
  const std::string& error() const noexcept override { return error_; }

 private:
  Disk& disk_;
  std::string error_ = "disk: No space left on device";
};

struct RetainRig : StationRig {
  RetainRig()
      : thread([this](int severity, const std::string& text) { log.emplace_back(severity, text); },
               kIntervalNs) {
    station->set_epoch(5);
    program->on_execute = [this](Cycle& cycle) {
      program->pieces = pieces;
      if (urgent) cycle.save_retained();
    };
    thread.add(*station, std::make_unique<FakeStore>(disk));
    push(Verb::start);
    scan();
    scan();
    thread.pass(0, true);
    disk.saved.clear();
  }
  /// The program ends a scan with so many pieces.
  void make(std::uint32_t count) {
    pieces = count;
    scan();
  }

  Disk disk;
  std::vector<std::pair<int, std::string>> log;
  std::uint32_t pieces = 0;
  bool urgent = false;
  RetainThread thread;
};

using Saved = std::vector<Slot>;

TEST_CASE("Retained tags that do not change are not saved again (IMG-4)") {
  RetainRig rig;
  for (int i = 1; i < 10; ++i) {
    rig.scan();
    rig.thread.pass(i * kIntervalNs, false);
  }
  CHECK(rig.disk.saved.empty());
}

TEST_CASE("Changed retained tags are saved within the interval, with the epoch, not more often (IMG-4)") {
  RetainRig rig;
  rig.make(1);
  rig.thread.pass(kIntervalNs, false);
  CHECK(rig.disk.saved == Saved{1});
  CHECK(rig.disk.epoch == 5);
  rig.make(2);
  rig.thread.pass(2 * kIntervalNs - 1, false);
  CHECK(rig.disk.saved == Saved{1});
  rig.make(3);
  rig.thread.pass(2 * kIntervalNs, false);
  CHECK(rig.disk.saved == Saved{1, 3});
}

TEST_CASE("Urgent retained tags are saved at the next look, and the program is told so (IMG-4, IMG-5)") {
  RetainRig rig;
  rig.make(1);
  rig.thread.pass(kIntervalNs, false);
  rig.urgent = true;
  rig.make(2);
  rig.urgent = false;
  const std::uint64_t asked = rig.station->retain().urgent_scan.load();
  CHECK(rig.station->retain().saved_scan.load() < asked);
  rig.thread.pass(kIntervalNs + 1, false);
  CHECK(rig.disk.saved == Saved{1, 2});
  CHECK(rig.station->retain().saved_scan.load() >= asked);
}

TEST_CASE("Full disk is said once, tried again each interval, and its end is said once (IMG-4)") {
  RetainRig rig;
  rig.disk.full = true;
  rig.urgent = true;  // a full disk is not hammered, whatever waits
  rig.make(7);
  for (std::int64_t ns = kIntervalNs; ns < 6 * kIntervalNs; ns += kIntervalNs / 100) {
    rig.scan();
    rig.thread.pass(ns, false);
  }
  REQUIRE(rig.log.size() == 1);
  CHECK(rig.log[0].first == 3);
  CHECK(rig.log[0].second == "station ST: retained tags are not written: disk: No space left on device");
  CHECK(rig.station->retain().saved_scan.load() < rig.station->retain().urgent_scan.load());
  rig.disk.full = false;
  rig.thread.pass(7 * kIntervalNs, false);
  CHECK(rig.disk.saved == Saved{7});
  REQUIRE(rig.log.size() == 2);
  CHECK(rig.log[1].second == "station ST: retained tags are written again");
  CHECK(rig.station->retain().saved_scan.load() >= rig.station->retain().urgent_scan.load());
}

TEST_CASE("Last look saves what is not saved yet, however recent the last save (IMG-4, SYS-1)") {
  RetainRig rig;
  rig.make(1);
  rig.thread.pass(kIntervalNs, false);
  rig.make(2);
  rig.thread.pass(kIntervalNs + 1, true);
  CHECK(rig.disk.saved == Saved{1, 2});
}

TEST_CASE("Retain thread that is stopped has saved all (IMG-4, SYS-1)") {
  RetainRig rig;
  rig.thread.start();
  rig.make(9);
  rig.thread.stop();
  REQUIRE_FALSE(rig.disk.saved.empty());
  CHECK(rig.disk.saved.back() == 9);
}

TEST_CASE("Station whose disk is full does not keep another from being saved (IMG-4)") {
  RetainRig rig;
  Disk other_disk;
  StationRig other(StationRig::named("OTHER"));
  rig.thread.add(*other.station, std::make_unique<FakeStore>(other_disk));
  other.program->on_execute = [&](Cycle&) { other.program->pieces = 4; };
  other.go(StationState::RUNNING);
  other.scan();
  rig.disk.full = true;
  rig.make(1);
  rig.thread.pass(kIntervalNs, false);
  CHECK(rig.disk.saved.empty());
  REQUIRE_FALSE(other_disk.saved.empty());
  CHECK(other_disk.saved.back() == 4);
}

}  // namespace
}  // namespace stationd::test

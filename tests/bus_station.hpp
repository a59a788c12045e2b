// A tiny station for the bridge's tests, scanned by a thread of its own every few milliseconds.
// Owned by the test.
// The test's thread sets up and looks; the scan thread runs the station.
#pragma once

#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "dds_bridge/station_bridge.hpp"
#include "scan/clock.hpp"
#include "scan/codes.hpp"
#include "scan/cycle.hpp"
#include "scan/program.hpp"
#include "scan/station.hpp"

namespace stationd::bus::test {

/// Announces as CODE what `speed` says; raises `notes` events after Start, a few per scan; faults on demand.
class Tiny : public Program {
 public:
  Tiny() {
    publish("Set", {{"CODE", &code}, {"SEQ", &seq}});
    publish("End", {{"CODE", &code}, {"ERROR", &error}});
    subscribe("Set", "loader", {{"CODE", &loader_code}, {"EPOCH", &loader_epoch}, {"SEQ", &loader_seq}});
    subscribe("Status", "sealer", {{"READY", &sealer_ready}, {"STATE", &sealer_state}});
  }
  void execute(Cycle& cycle) noexcept override {
    if (cycle.started()) {
      seq = seq + 1;
      raised_ = 0;
    }
    code = std::uint32_t{speed};
    constexpr std::uint32_t kPerScan = 50;
    for (std::uint32_t i = 0; i < kPerScan && raised_ < notes; ++i)
      cycle.note(code::order_refused, ++raised_);
    if (fault.get()) cycle.fault(code::overrun, 1);
    if (cycle.finishing()) cycle.finished();
    cycle.report(3, code, true);
  }
  std::string_view step_name(std::uint32_t step) const noexcept override { return step == 3 ? "fit" : ""; }

  In<std::uint32_t> loader_code{*this, "loader.code", ""}, loader_epoch{*this, "loader.epoch", ""},
      loader_seq{*this, "loader.seq", ""}, sealer_state{*this, "sealer.state", ""};
  In<bool> sealer_ready{*this, "sealer.ready", ""};
  Var<std::uint32_t> code{*this, "code", ""}, seq{*this, "seq", ""};
  Var<bool> error{*this, "error", "", true};
  Param<std::uint16_t> speed{*this, "speed", "", 101, 1, 1000};
  Param<Time> delay{*this, "delay", "", Time{300'000'000}, Time{0}, Time{10'000'000'000}};
  Param<std::uint32_t> notes{*this, "notes", "", 0, 0, 100'000};
  Param<bool> fault{*this, "fault", "", false, false, true};

 private:
  std::uint32_t raised_ = 0;
};

class ScannedStation {
 public:
  explicit ScannedStation(const std::string& name, std::size_t requests = 64)
      : station_(options(name, requests), program()) {
    station_.image().spec(*station_.image().find("speed")).writable = true;
    station_.set_bus_limits(1'000'000'000, 2'000'000'000);
    station_.seal();
  }
  ~ScannedStation() { stop(); }

  Station& station() { return station_; }
  Tiny& tiny() { return *tiny_; }
  /// Scans from now on; `wake_fd` as the bridge gave it.
  void scan(int wake_fd) {
    wake_fd_ = wake_fd;
    thread_ = std::thread([this] { run(); });
  }
  void stop() {
    end_ = true;
    if (thread_.joinable()) thread_.join();
  }
  /// While held, no scan runs: what is sent to the station waits.
  std::atomic<bool> hold{false};
  std::atomic<std::uint32_t> loader_code{0}, sealer_state{0};
  std::atomic<bool> loader_good{false};

 private:
  static StationOptions options(const std::string& name, std::size_t requests) {
    StationOptions options;
    options.name = name;
    options.epoch = 7;
    options.pv_heartbeat_ns = 20'000'000;
    options.request_capacity = requests;
    return options;
  }
  std::unique_ptr<Program> program() {
    auto tiny = std::make_unique<Tiny>();
    tiny_ = tiny.get();
    return tiny;
  }
  void run() {
    std::uint64_t scan = 0;
    const std::int64_t offset_ns = utc_offset_ns();
    while (!end_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      if (hold) continue;
      station_.begin(monotonic_ns(), ++scan, offset_ns);
      station_.latch();
      station_.execute();
      station_.commit();
      station_.publish(0);
      for (int i = 0; i < 32 && station_.service_one(); ++i) {
      }
      loader_code = tiny_->loader_code.get();
      loader_good = tiny_->loader_code.good();
      sealer_state = tiny_->sealer_state.get();
      const std::uint64_t one = 1;
      static_cast<void>(!write(wake_fd_, &one, sizeof(one)));
    }
  }

  Tiny* tiny_ = nullptr;
  Station station_;
  int wake_fd_ = -1;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace stationd::bus::test

// SharedPlant, SimulatedBackend: one plant in the daemon's own process, a unit of it for each device.
// SharedPlant is owned jointly by its backends; a SimulatedBackend by its device.
// SharedPlant: any device thread (a mutex inside; never a scan). SimulatedBackend: its device thread only.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "io/backend.hpp"
#include "io/options.hpp"
#include "io/plant/live_plant.hpp"

namespace stationd::io {

class SharedPlant {
 public:
  /// Set-up. Throws as Plant and LivePlant do.
  explicit SharedPlant(const PlantOptions& options);
  SharedPlant(plant::PlantConfig config, plant::LiveOptions options);
  /// Writes the ledger for the last time; a failure to do so is lost.
  ~SharedPlant();
  SharedPlant(const SharedPlant&) = delete;
  SharedPlant& operator=(const SharedPlant&) = delete;

  /// Any thread but a scan. Brings the plant up to `now_ns` (CLOCK_MONOTONIC) and calls `use(plant)` under
  /// the mutex.
  template <class Use> auto with(std::int64_t now_ns, Use use) {
    const std::lock_guard lock(mutex_);
    live_.advance(now_ns);
    return use(live_.plant());
  }

  /// Any thread but a scan. Writes the ledger file when due; another thread's writing is not waited for.
  /// Empty, or what went wrong.
  std::string write_due(std::int64_t now_ns);

 private:
  std::mutex mutex_;       // the plant
  std::mutex file_mutex_;  // the files
  plant::LivePlant live_;
};

class SimulatedBackend : public Backend {
 public:
  /// `unit` 1 to 4. Throws std::invalid_argument naming the tag whose table, address, type or direction is
  /// not to be had.
  SimulatedBackend(std::shared_ptr<SharedPlant> plant, int unit, std::vector<Point> points);

  ExchangeResult exchange(std::span<const OutputValue> outputs, std::span<Slot> inputs,
                          std::int64_t now_ns) override;
  void close() noexcept override {}

 private:
  std::shared_ptr<SharedPlant> plant_;
  int unit_;
  std::vector<Point> inputs_;
  std::vector<Point> outputs_;
};

}  // namespace stationd::io

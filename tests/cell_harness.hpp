// CellHarness: the four stations with their programs, the plant, an in-process bus and a fake retain store,
// in virtual time.
// Owned by a test.
// The test's thread alone; no clock, no sleep, no DDS.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "io/plant/plant.hpp"
#include "scan/station.hpp"

namespace stationd::test {

#ifdef CELL_THINNED
inline constexpr int kThin = CELL_THINNED;  ///< builds with sanitizers are slow: every so-manieth run only
#else
inline constexpr int kThin = 1;
#endif
inline constexpr std::int64_t kMs = 1'000'000;
inline constexpr std::int64_t kSecond = 1'000 * kMs;
inline constexpr std::array<const char*, 4> kStationNames = {"loader", "robot", "sealer", "storage"};
inline constexpr int kLoader = 1, kRobot = 2, kSealer = 3, kStorage = 4;

struct CellOptions {
  std::uint64_t seed = 1;
  std::uint32_t pallets = 10;
  std::vector<std::uint32_t> codes;  ///< of the first pallets
  std::int64_t scan_ns = 10 * kMs;
  std::int64_t plant_step_ns = 10 * kMs;
  std::uint64_t commit_after_scans = 2;  ///< how long the fake disk takes
  double samples_lost = 0;               ///< share of PV samples that the bus loses
};

/// What became of the outputs of a station that died.
enum class AfterDeath { drop_at_once, stay_a_while };

class CellHarness {
 public:
  explicit CellHarness(CellOptions options);

  plant::Plant& plant() noexcept { return plant_; }
  std::int64_t now_ns() const noexcept { return now_ns_; }

  // -- running
  /// One scan of all stations that live, after the plant's steps up to its time.
  void scan();
  /// Until `done` or for that long; true if done. The operator and the supervisor act meanwhile.
  bool run_until(const std::function<bool()>& done, std::int64_t at_most_ns);
  /// Until every pallet has left the cell or was taken out; true if so.
  bool run_out(std::int64_t at_most_ns);
  bool all_pallets_done() const;
  /// The plant's own judgement of the run, empty when all is well; else what is wrong.
  std::string complaint() const;

  // -- orders
  void start(int unit);
  void stop(int unit, StopMode mode);
  void reset(int unit);
  StationState state(int unit) const;
  bool alive(int unit) const { return units_[index(unit)].station != nullptr; }
  Station& station(int unit) { return *units_[index(unit)].station; }
  std::uint32_t track_step(int unit) const { return step_tag(unit, "track_step"); }
  std::uint32_t arm_step(int unit) const { return step_tag(unit, "arm_step"); }
  /// Steps of track and arm that the station was in at the end of a scan.
  const std::set<std::uint32_t>& visited(int unit) const { return units_[index(unit)].visited; }
  /// Every step that the program has a name for.
  static std::set<std::uint32_t> all_steps(const std::string& program);

  // -- trouble
  /// kill -9: what the fake disk had not committed is lost; what was being written may or may not be there.
  void kill(int unit, AfterDeath after, bool last_write_made_it);
  /// Another process: next epoch, retained data as the disk has them (or none), STOPPED.
  void revive(int unit, bool cold = false);
  /// The field device of that unit does not answer.
  void cut_device(int unit, bool cut) { units_[index(unit)].cut = cut; }
  /// No sample of that source ("End/loader") arrives anywhere; empty: all do.
  void withhold(const std::string& source) { withheld_ = source; }
  void set_samples_lost(double share) { options_.samples_lost = share; }

  // -- people
  /// Starts what is STOPPED though it should run; off for the stations that a test stops itself.
  std::array<bool, 4> keep_running = {true, true, true, true};
  /// Repairs, answers, resets, and starts what is in FAULT, after a while.
  bool operator_acts = true;
  bool operator_repairs = true;  ///< clears injected faults first
  /// Codes of faults (and warnings) raised so far, by unit.
  const std::map<std::uint32_t, int>& raised(int unit) const { return units_[index(unit)].raised; }
  int faults_raised() const;
  /// Pieces that the station's End named, each once: with an error or without.
  std::size_t ended(int unit, bool with_error) const {
    return units_[index(unit)].ended[with_error ? 1 : 0].size();
  }

 private:
  struct Write {
    std::vector<Slot> slots;
    std::uint64_t scan = 0, done_at = 0;
  };
  struct Unit {
    std::string name;
    std::unique_ptr<Station> station;
    std::uint32_t epoch = 0;
    std::uint64_t scan = 0;
    std::vector<Slot> disk;
    bool has_disk = false;
    bool writing = false;
    Write write;
    std::uint64_t last_saved = 0;
    bool permitted = false;
    std::uint64_t safe_block = 0;
    std::uint64_t inputs_count = 0;
    std::int64_t drop_at_ns = -1;
    std::int64_t fault_since_ns = -1;
    bool cut = false;
    std::vector<std::function<Slot(const plant::UnitIo&)>> readers;
    Slot* track_step = nullptr;
    Slot* arm_step = nullptr;
    std::set<std::uint32_t> visited;
    std::map<std::uint32_t, int> raised;
    std::array<std::set<std::pair<Slot, Slot>>, 2> ended;
  };
  /// The newest sample of one topic of one station, by member.
  struct Sample {
    std::map<std::string, Slot> members;
    std::uint64_t count = 0;
  };

  static std::size_t index(int unit) { return static_cast<std::size_t>(unit - 1); }
  std::uint32_t step_tag(int unit, const char* name) const;
  void feed_inputs(int unit);
  void drive_outputs(int unit);
  void serve_retain(Unit& unit) const;
  void serve_bus(int unit);
  void deliver(const std::string& source, const std::vector<std::string>& members,
               const std::vector<Slot>& values);
  void collect_events(Unit& unit);
  void count_end(Unit& unit, const PvLink& pv, ConstBlockView block);
  void act_as_people();
  void answer(int unit, std::uint32_t code);
  bool lost();

  CellOptions options_;
  plant::Plant plant_;
  std::array<Unit, 4> units_;
  std::int64_t now_ns_ = 0;
  std::uint64_t orders_ = 0;
  std::uint64_t deliveries_ = 0;
  std::string withheld_;
  std::mt19937_64 random_;
};

}  // namespace stationd::test

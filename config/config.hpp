// Configuration: one TOML file per controller (or supervisor) as one typed, validated value.
// Owned by the composer (daemon, supervisor, command line), which copies from it at set-up.
// Set-up only; one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "dds_bridge/options.hpp"
#include "io/options.hpp"
#include "scan/image.hpp"
#include "scan/program.hpp"
#include "scan/station.hpp"

namespace stationd::config {

/// Where in the file something was said; both count from 1. 0: nowhere (a default).
struct Position {
  std::uint32_t line = 0;
  std::uint32_t column = 0;
};

/// One error in a file. `text` is complete: "FILE:LINE:COLUMN: KEY: what was found; what is allowed".
struct Problem {
  Position position;
  std::string text;
};

/// Either a value and no problems, or all problems that were found, in the order of the file.
template <class T> struct [[nodiscard]] Result {
  std::optional<T> value;
  std::vector<Problem> problems;
  explicit operator bool() const noexcept { return value.has_value(); }
};

/// What a task does about a scan that still runs (or was not woken) at its next due time.
enum class Overrun : std::uint8_t {
  skip,  ///< goes on at the next due time of the grid; skipped cycles are counted
  fault  ///< its stations go to FAULT
};

enum class LogLevel : std::uint8_t { debug, info, warning, error };

struct TaskConfig {
  std::string name;
  std::int64_t period_ns = 10'000'000;  ///< 250 us to 60 s
  std::int64_t phase_ns = 0;            ///< 0 to below the period
  int priority = 80;                    ///< SCHED_FIFO, 1..95
  int cpu = -1;                         ///< -1: any
  Overrun overrun = Overrun::skip;
  std::int64_t watchdog_ns = 0;  ///< at least the period; default the longer of 10 periods and 100 ms
  std::int64_t spin_ns = 0;      ///< wake early by that much and busy-wait; below the period
  Position position;
};

/// A value as the file says it; monostate: it does not, or what it says is no value.
using RawValue = std::variant<std::monostate, bool, std::int64_t, double, std::string>;

/// One tag and its place in a device.
struct TagMapping {
  std::string tag;
  std::string device;
  /// `type` is the program's once check_stations() has seen it. So are safe_action and safe_value of an
  /// output whose mapping says nothing about them: copy both into the image's TagSpec (hold, safe).
  io::Point point;
  std::optional<TagType> type;  ///< as the file says, if it does
  std::int64_t max_age_ns =
      0;                    ///< inputs: STALE when older; never 0 after loading (the device's stale_after)
  bool safe_given = false;  ///< outputs: the file has `safe = ...`
  Position position;        ///< of the tag's name
  Position at_position, type_position, safe_position, max_age_position;
  RawValue safe_raw;
};

/// What the file says of a tag of the program's own: a parameter's value, or what an operator may set.
struct ParameterConfig {
  std::string tag;
  std::optional<TagType> type;
  RawValue raw;  ///< a parameter's value; monostate: the program's default
  RawValue raw_min, raw_max;
  bool writable = false;  ///< an operator may set it while the station runs
  /// Once check_stations() has seen them: in the tag's own encoding, within the program's range. Both limits
  /// 0: the type's own range.
  Slot value = 0, min = 0, max = 0;
  Position position, value_position, min_position, max_position;
};

struct StationConfig {
  std::string name;
  std::string task;
  std::string program;
  OnRestart on_restart = OnRestart::stopped;
  std::string upstream;    ///< station before this one, perhaps on another controller; empty: none
  std::string downstream;  ///< station behind this one; empty: none
  std::vector<TagMapping> inputs, outputs;
  std::vector<ParameterConfig> parameters;
  std::vector<ParameterConfig> tags;  ///< internal and retained ones that are writable
  Position position, program_position;
};

/// A controller's file: `stationd FILE`.
struct Configuration {
  std::filesystem::path file;
  std::string name;                 ///< of the controller
  std::filesystem::path state_dir;  ///< default: $STATE_DIRECTORY, or /var/lib/stationd
  bool require_realtime = false;
  bool keep_cpus_awake = true;    ///< where a task has a real-time priority
  bool restart_on_stuck = false;  ///< a stuck task also leaves the service manager's watchdog unfed
  LogLevel log_level = LogLevel::info;
  bus::Options bus;  ///< bus.name is the controller's name
  std::int64_t pv_heartbeat_ns =
      100'000'000;  ///< PVs are repeated at least so often; a quarter of bus.deadline_ns at most
  std::int64_t bus_stale_after_ns = 500'000'000;  ///< remote PVs: see Station::set_bus_limits()
  std::int64_t bus_bad_after_ns = 2'000'000'000;
  io::PlantOptions plant;  ///< of the devices with DeviceKind::simulated
  std::vector<TaskConfig> tasks;
  std::vector<io::DeviceOptions> devices;
  std::vector<Recipe> recipes;
  std::vector<StationConfig> stations;  ///< stations of one task run in this order

  const TaskConfig* task(std::string_view task_name) const;
  const io::DeviceOptions* device(std::string_view device_name) const;
};

/// The supervisor's file.
struct SupervisorConfiguration {
  std::filesystem::path file;
  std::string name = "supervisor";
  LogLevel log_level = LogLevel::info;
  bus::Options bus;                    ///< bus.name is the supervisor's name
  std::vector<std::string> stations;   ///< in the order in which they are started
  std::filesystem::path state_dir;     ///< default: $STATE_DIRECTORY, or /var/lib/stationd
  std::filesystem::path journal_file;  ///< of received events and of intent; absolute, or in state_dir
  std::int64_t start_repeat_ns = 500'000'000;   ///< Start is repeated so often until Status confirms it
  std::int64_t stale_after_ns = 1'000'000'000;  ///< a station whose Status is older counts as away
};

/// What a program declares, as far as the configuration has to agree with it.
struct ProgramTags {
  std::vector<TagSpec> tags;
  std::vector<std::string> bus_inputs;  ///< input tags that the program's own subscriptions feed
};

/// The programs that there are; the daemon supplies it, since the configuration does not know them.
struct ProgramCatalogue {
  std::vector<std::string> names;
  /// The tags of a program made with these options. May throw SetupError (a recipe's value is missing,
  /// say): becomes a problem at the station's `program`.
  std::function<ProgramTags(const std::string& program, const ProgramOptions& options)> tags;
};

/// Reads and checks a file; with a catalogue also what check_stations() checks, all errors at once.
/// An unreadable file is a problem like any other. Throws nothing but std::bad_alloc.
Result<Configuration> load_controller(const std::filesystem::path& file,
                                      const ProgramCatalogue* programs = nullptr);
Result<SupervisorConfiguration> load_supervisor(const std::filesystem::path& file);
/// The same from memory; `file` is for messages only.
Result<Configuration> parse_controller(std::string_view text, const std::filesystem::path& file,
                                       const ProgramCatalogue* programs = nullptr);
Result<SupervisorConfiguration> parse_supervisor(std::string_view text, const std::filesystem::path& file);

/// Holds each station against its program: unknown program or tag, wrong area or type, inputs and outputs
/// without a place, parameters out of range, registers that overlap. Fills in Point::type, safe_action,
/// safe_value and ParameterConfig::value. No problems: the configuration is fit to be set up.
std::vector<Problem> check_stations(Configuration& configuration, const ProgramCatalogue& programs);

/// "FILE:LINE:COLUMN: KEY: TEXT", for an error that only the caller can see.
std::string message(const std::filesystem::path& file, Position position, std::string_view key,
                    std::string_view text);

/// docs/configuration.md, made from the key tables.
std::string reference_markdown();

}  // namespace stationd::config

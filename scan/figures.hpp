// Figures: what is measured of a station's scans, over which time, and how it is summed up.
// Owned by whoever tells it: the daemon's statistics, a message, stationctl.
// Any thread; plain values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace stationd {

/// What is measured of a station's scans. Lateness is the task's: its stations share one wake-up and one
/// time.
enum class Figure : std::uint8_t {
  lateness,        ///< due time to wake-up
  execution,       ///< the station's latch, execute and commit
  response,        ///< due time to the station's outputs committed
  task_execution,  ///< the same of all stations of the task
  task_response,
  latch,  ///< phases of the task
  execute,
  commit,
  publish,
  service
};
inline constexpr std::size_t kFigures = 10;
/// "task_execution"
std::string_view name_of(Figure figure) noexcept;
/// Nothing: there is no figure of that name.
std::optional<Figure> find_figure(std::string_view name) noexcept;

/// The last minute is the newest 60 to 70 s: whole windows of 10 s are forgotten at once.
enum class Window : std::uint8_t { since_start, last_minute };
inline constexpr std::size_t kWindows = 2;
/// "since_start"
std::string_view name_of(Window window) noexcept;

/// Count and mean are exact, minimum and maximum since start too; the rest is at most 1 % off (see Buckets).
/// What overflowed is told as the maximum since start. All 0 while nothing was recorded.
struct Summary {
  std::uint64_t count = 0;
  std::int64_t min_ns = 0, mean_ns = 0, p50_ns = 0, p99_ns = 0, p999_ns = 0, max_ns = 0;
};

struct BucketCount {
  std::size_t bucket = 0;  ///< see Buckets
  std::uint64_t count = 0;
};

}  // namespace stationd

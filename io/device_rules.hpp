// Rules of a device's rounds: which outputs go out, and what is said of losing the device and of its return.
// Owned by the device.
// Pure: the time comes in as a value. The device's thread, or a test.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "io/backend.hpp"
#include "io/options.hpp"
#include "scan/links.hpp"

namespace stationd::io {

/// One station's share of a device. Links may be null; `permit` may not.
struct DeviceBinding {
  InputLink* inputs = nullptr;
  OutputLink* outputs = nullptr;
  const std::atomic<bool>* permit = nullptr;
  std::vector<std::uint32_t> input_points;  ///< for each tag of `inputs`: its place among the device's inputs
  std::vector<std::uint32_t>
      output_points;  ///< for each tag of `outputs`: its place among the device's outputs
};

/// The safe value of each output point, in their order.
std::vector<OutputValue> safe_values(const std::vector<Point>& points);
std::size_t count_of(const std::vector<Point>& points, Direction direction);

/// What becomes of the outputs of one round. The program's values stand only with the station's permit, and
/// only from a block that the scan committed after the permit was seen: the block before it is from the time
/// before Start, where an output that is to be held has no value of the program's yet.
class OutputSelection {
 public:
  OutputSelection(const std::vector<Point>& points, std::vector<DeviceBinding>& bindings);
  /// `returning`: the device was not reached in the round before this, or is to be left safe.
  const std::vector<OutputValue>& select(bool returning) noexcept;

 private:
  enum class Drive : std::uint8_t { safe, awaiting_block, program };

  std::vector<OutputValue> safe_;
  std::vector<OutputValue> now_;
  std::vector<DeviceBinding>& bindings_;
  std::vector<Drive> drives_;
};

/// A line for the log; severity 0 debug .. 3 error. Empty text: nothing to say.
struct DeviceLine {
  int severity = 1;
  std::string text;
};

/// Follows the results of the rounds: one line per change, at most one a second, none kept back for good. The
/// event of a lost device is the station's, which sees its inputs turn BAD.
class DeviceReport {
 public:
  static constexpr std::int64_t kLineEveryNs = 1'000'000'000;

  explicit DeviceReport(const DeviceOptions& options);
  DeviceLine line(const ExchangeResult& result, std::int64_t now_ns);

 private:
  enum class Said : std::uint8_t { nothing, ok, failed };

  std::string where_;
  Said said_ = Said::nothing;
  bool ok_ = false;
  bool seen_ = false;     // any round yet
  bool reached_ = false;  // ever ok
  std::int64_t failing_since_ns_ = 0;
  std::int64_t failed_for_ns_ = 0;
  std::int64_t next_line_ns_ = INT64_MIN;
  std::uint64_t changes_ = 0;  // since the last line
};

/// For people: "no answer in time (read di 0..19), code 110".
std::string describe(const ExchangeResult& result);

}  // namespace stationd::io

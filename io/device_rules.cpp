#include "io/device_rules.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace stationd::io {

std::vector<OutputValue> safe_values(const std::vector<Point>& points) {
  std::vector<OutputValue> values;
  for (const Point& point : points)
    if (point.direction == Direction::output)
      values.push_back({point.safe_value, point.safe_action == SafeAction::value});
  return values;
}

std::size_t count_of(const std::vector<Point>& points, Direction direction) {
  return static_cast<std::size_t>(
      std::count_if(points.begin(), points.end(),
                    [direction](const Point& point) { return point.direction == direction; }));
}

OutputSelection::OutputSelection(const std::vector<Point>& points, std::vector<DeviceBinding>& bindings)
    : safe_(safe_values(points)), now_(safe_), bindings_(bindings), drives_(bindings.size(), Drive::safe) {}

const std::vector<OutputValue>& OutputSelection::select(bool returning) noexcept {
  std::copy(safe_.begin(), safe_.end(), now_.begin());
  for (std::size_t b = 0; b < bindings_.size(); ++b) {
    DeviceBinding& binding = bindings_[b];
    if (binding.outputs == nullptr) continue;
    // The permit is read before the block: a block that is newer than the permit can only be safer.
    const bool permitted = binding.permit->load(std::memory_order_acquire);
    const bool fresh = binding.outputs->blocks.update();
    Drive& drive = drives_[b];
    if (!permitted)
      drive = Drive::safe;
    else if (drive == Drive::safe)
      drive = Drive::awaiting_block;
    else if (fresh)
      drive = Drive::program;
    if (drive != Drive::program || returning) continue;
    const ConstBlockView block{binding.outputs->blocks.readable(), binding.outputs->tags.layout};
    for (std::size_t i = 0; i < binding.output_points.size(); ++i)
      now_[binding.output_points[i]] = {block.slots()[i], true};
  }
  return now_;
}

DeviceReport::DeviceReport(const DeviceOptions& options) : where_("device " + options.name) {
  if (options.kind == DeviceKind::modbus)
    where_ += " (" + options.host + ":" + std::to_string(options.port) + " unit " +
              std::to_string(options.unit) + ")";
}

DeviceLine DeviceReport::line(const ExchangeResult& result, std::int64_t now_ns) {
  const bool ok = result.status == ExchangeStatus::ok;
  if (!seen_ || ok != ok_) {
    ++changes_;
    if (!ok)
      failing_since_ns_ = now_ns;
    else
      failed_for_ns_ = now_ns - failing_since_ns_;
  }
  seen_ = true;
  ok_ = ok;
  const bool was_reached = reached_;
  reached_ = reached_ || ok;
  const Said now = ok ? Said::ok : Said::failed;
  if (now == said_ || now_ns < next_line_ns_) return {};
  const std::string more = changes_ <= 1
                               ? std::string()
                               : "; " + std::to_string(changes_ - 1) + " changes before this were not said";
  const bool first = said_ == Said::nothing;
  said_ = now;
  changes_ = 0;
  next_line_ns_ = now_ns + kLineEveryNs;
  if (ok && first) return {1, where_ + ": connected" + more};
  if (ok)
    return {1, where_ + ": back after " + std::to_string(failed_for_ns_ / 1'000'000) +
                   " ms, safe values first" + more};
  return {2, where_ + (was_reached ? ": lost: " : ": not reached: ") + describe(result) + more};
}

std::string describe(const ExchangeResult& result) {
  static constexpr std::array<const char*, 5> kinds = {
      "ok", "no connection", "no answer in time", "an answer that breaks the protocol", "the device refused"};
  std::string text = kinds[static_cast<std::size_t>(result.status)];
  if (result.detail != nullptr && *result.detail != '\0') text += std::string(" (") + result.detail + ")";
  if (result.code == 0) return text;
  if (result.status == ExchangeStatus::exception)
    return text + ", Modbus exception " + std::to_string(result.code);
  std::array<char, 128> buffer{};
  return text + ": " + strerror_r(result.code, buffer.data(), buffer.size());
}

}  // namespace stationd::io

#include "io/plant/simulated_backend.hpp"

#include <algorithm>
#include <stdexcept>

namespace stationd::io {

namespace {

using plant::UnitIo;

struct Size {
  std::size_t table = 0;  ///< addresses in the table
  std::size_t point = 0;  ///< addresses that the point takes; 0: its type cannot be there
};

/// 0 for types that a register does not hold as they are.
std::size_t registers_of(const Point& point) noexcept {
  switch (point.type) {
    case TagType::BOOL:
    case TagType::SINT:
    case TagType::USINT:
    case TagType::STRING: return 0;
    default: return width_of(point.table, point.type);
  }
}

Size size_of(const Point& point) noexcept {
  const std::size_t bits = point.type == TagType::BOOL ? 1 : 0;
  switch (point.table) {
    case Table::coil: return {plant::kCoils, bits};
    case Table::discrete_input: return {plant::kDiscreteInputs, bits};
    case Table::holding_register: return {plant::kHoldingRegisters, registers_of(point)};
    case Table::input_register: return {plant::kInputRegisters, registers_of(point)};
  }
  return {};
}

const char* name_of(Table table) noexcept {
  switch (table) {
    case Table::coil: return "coil";
    case Table::discrete_input: return "discrete input";
    case Table::holding_register: return "holding register";
    case Table::input_register: return "input register";
  }
  return "";
}

void check(const Point& point) {
  const auto refuse = [&](const std::string& why) { throw std::invalid_argument(point.tag + ": " + why); };
  const Size size = size_of(point);
  const std::string place = std::string(name_of(point.table)) + " " + std::to_string(point.address);
  if (size.point == 0) refuse(std::string(stationd::name_of(point.type)) + " cannot be at " + place);
  if (point.address + size.point > size.table) {
    refuse("the simulated plant has no " + place + (size.point > 1 ? " to " : "") +
           (size.point > 1 ? std::to_string(point.address + size.point - 1) : "") + ", only 0 to " +
           std::to_string(size.table - 1));
  }
  const bool read_only = point.table == Table::discrete_input || point.table == Table::input_register;
  if (point.direction == Direction::output && read_only) refuse(place + " is read-only");
}

Slot sign_extended(TagType type, Slot value) noexcept {
  if (type == TagType::INT) return to_slot(static_cast<std::int16_t>(value));
  if (type == TagType::DINT) return to_slot(static_cast<std::int32_t>(value));
  return value;
}

Slot read_point(const UnitIo& io, const Point& point) noexcept {
  if (point.table == Table::coil) return io.coils[point.address];
  if (point.table == Table::discrete_input) return io.discrete_inputs[point.address];
  const std::uint16_t* const registers =
      point.table == Table::input_register ? io.input_registers.data() : io.holding_registers.data();
  Slot value = 0;
  for (std::size_t i = 0; i < registers_of(point); ++i) value = (value << 16) | registers[point.address + i];
  return sign_extended(point.type, value);
}

void write_point(UnitIo& io, const Point& point, Slot value) noexcept {
  if (point.table == Table::coil) {
    io.coils[point.address] = value != 0;
    return;
  }
  for (std::size_t i = registers_of(point); i > 0; --i) {
    io.holding_registers[point.address + i - 1] = static_cast<std::uint16_t>(value & 0xFFFF);
    value >>= 16;
  }
}

plant::PlantConfig config_of(const PlantOptions& options) {
  plant::PlantConfig config;
  config.seed = options.seed;
  config.pallets = options.pallets;
  config.step_ns = options.step_ns;
  return config;
}

}  // namespace

SharedPlant::SharedPlant(const PlantOptions& options)
    : SharedPlant(config_of(options), {options.speed, options.ledger_file, {}}) {}

SharedPlant::SharedPlant(plant::PlantConfig config, plant::LiveOptions options)
    : live_(std::move(config), std::move(options)) {}

SharedPlant::~SharedPlant() {
  try {
    live_.finish();
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): nobody is left to tell
  }
}

std::string SharedPlant::write_due(std::int64_t now_ns) {
  const std::unique_lock file_lock(file_mutex_, std::try_to_lock);
  if (!file_lock.owns_lock()) return {};
  plant::LivePlant::Due due;
  {
    const std::lock_guard lock(mutex_);
    due = live_.due(now_ns);
  }
  try {
    live_.write(due);
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

SimulatedBackend::SimulatedBackend(std::shared_ptr<SharedPlant> plant, int unit, std::vector<Point> points)
    : plant_(std::move(plant)), unit_(unit) {
  if (unit < 1 || unit > plant::kUnits) {
    throw std::invalid_argument("the simulated plant has units 1 to 4, not " + std::to_string(unit));
  }
  for (Point& point : points) {
    check(point);
    (point.direction == Direction::input ? inputs_ : outputs_).push_back(std::move(point));
  }
}

ExchangeResult SimulatedBackend::exchange(std::span<const OutputValue> outputs, std::span<Slot> inputs,
                                          std::int64_t now_ns) {
  plant_->with(now_ns, [&](plant::Plant& model) {
    UnitIo& io = model.unit(unit_);
    for (std::size_t i = 0; i < std::min(outputs.size(), outputs_.size()); ++i) {
      if (outputs[i].write) write_point(io, outputs_[i], outputs[i].value);
    }
    if (!outputs_.empty()) model.note_write(unit_);
    for (std::size_t i = 0; i < std::min(inputs.size(), inputs_.size()); ++i)
      inputs[i] = read_point(io, inputs_[i]);
  });
  // The ledger is a by-product: a disk that is full must not look like a device that is lost.
  static_cast<void>(plant_->write_due(now_ns));
  return {};
}

}  // namespace stationd::io

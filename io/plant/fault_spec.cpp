// parse_fault: what `plantsim --inject` takes.
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "io/plant/faults.hpp"
#include "io/plant/parse.hpp"

namespace stationd::plant {

namespace {

struct Name {
  std::string_view name;
  std::uint32_t index;
  int unit;  ///< 0: every unit
};

constexpr Name kInputs[] = {{"pallet_at_entry", 0, 0},
                            {"pallet_in_transfer", 1, 0},
                            {"pallet_in_position", 2, 0},
                            {"next_entry_clear", 3, 0},
                            {"entry_stopper_is_open", 4, 0},
                            {"entry_stopper_is_closed", 5, 0},
                            {"stopper_is_open", 6, 0},
                            {"stopper_is_closed", 7, 0},
                            {"clamp_is_closed", 8, 0},
                            {"clamp_is_open", 9, 0},
                            {"arm_is_up", 10, 0},
                            {"arm_is_down", 11, 0},
                            {"gripper_is_open", 12, 0},
                            {"gripper_is_closed", 13, 0},
                            {"part_in_gripper", 14, 0},
                            {"code_valid", 15, 0},
                            {"base_present", 16, 1},
                            {"bearing_present", 16, 2},
                            {"lid_present", 16, 3},
                            {"piece_present", 16, 4},
                            {"shaft_present", 17, 2},
                            {"press_is_up", 17, 3},
                            {"place_occupied", 17, 4},
                            {"press_is_down", 18, 3},
                            {"lid_seated", 19, 3}};
constexpr Name kCoilNames[] = {{"conveyor", 0, 0},    {"entry_stopper_open", 1, 0}, {"stopper_open", 2, 0},
                               {"clamp_close", 3, 0}, {"read_code", 4, 0},          {"arm_enable", 5, 0},
                               {"arm_down", 6, 0},    {"gripper_close", 7, 0},      {"press_down", 8, 3}};
constexpr Name kRegisters[] = {
    {"pallet_code_high", 0, 0}, {"pallet_code_low", 1, 0}, {"arm_position", 2, 0},    {"base_1_level", 3, 1},
    {"base_2_level", 4, 1},     {"bearing_1_level", 3, 2}, {"bearing_2_level", 4, 2}, {"shaft_1_level", 5, 2},
    {"shaft_2_level", 6, 2},    {"lid_1_level", 3, 3},     {"lid_2_level", 4, 3},     {"shelf_1_free", 3, 4},
    {"shelf_2_free", 4, 4}};
constexpr Name kFeeders[] = {{"base_1", 0, 1},  {"base_2", 1, 1},  {"bearing_1", 0, 2}, {"bearing_2", 1, 2},
                             {"shaft_1", 2, 2}, {"shaft_2", 3, 2}, {"lid_1", 0, 3},     {"lid_2", 1, 3},
                             {"shelf_1", 0, 4}, {"shelf_2", 1, 4}};
constexpr Name kZones[] = {{"entry", 0, 0}, {"transfer", 1, 0}, {"position", 2, 0}};
constexpr Name kPartNames[] = {{"base", 0, 0}, {"bearing", 1, 0}, {"shaft", 2, 0}, {"lid", 3, 0}};

std::span<const Name> names_of(FaultKind kind) noexcept {
  switch (kind) {
    case FaultKind::sensor_stuck: return kInputs;
    case FaultKind::register_stuck: return kRegisters;
    case FaultKind::actuator_jammed: return kCoilNames;
    case FaultKind::magazine_empty: return kFeeders;
    case FaultKind::pallet_lost: return kZones;
    case FaultKind::part_off_pallet: return kPartNames;
    default: return {};
  }
}

FaultKind kind_of(std::string_view text) {
  if (text == "sensor") return FaultKind::sensor_stuck;
  if (text == "register") return FaultKind::register_stuck;
  if (text == "jam") return FaultKind::actuator_jammed;
  std::string allowed = "sensor, register, jam";
  for (int i = 0; i <= static_cast<int>(FaultKind::infeed_stops); ++i) {
    const auto kind = static_cast<FaultKind>(i);
    if (text == name_of(kind)) return kind;
    allowed.append(", ").append(name_of(kind));
  }
  throw std::invalid_argument("\"" + std::string(text) + "\" is no kind of fault; there are: " + allowed);
}

std::uint32_t index_of(std::string_view text, FaultKind kind, int unit) {
  if (!text.empty() && text[0] >= '0' && text[0] <= '9') {
    return static_cast<std::uint32_t>(parse_integer(text, "index", 0, 31));
  }
  std::string allowed;
  for (const Name& name : names_of(kind)) {
    if (name.unit != 0 && name.unit != unit) continue;
    if (name.name == text) return name.index;
    allowed.append(allowed.empty() ? "" : ", ").append(name.name);
  }
  throw std::invalid_argument("\"" + std::string(text) + "\" is not known to " + std::string(name_of(kind)) +
                              " in unit " + std::to_string(unit) +
                              (allowed.empty() ? "" : "; there are: " + allowed));
}

/// Cuts `text` at its last `mark` and gives what is behind it.
std::optional<std::string_view> cut(std::string_view& text, char mark) {
  const std::size_t at = text.rfind(mark);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view behind = text.substr(at + 1);
  text = text.substr(0, at);
  return behind;
}

}  // namespace

Fault parse_fault(std::string_view spec) {
  Fault fault;
  std::string_view rest = spec;
  if (const auto text = cut(rest, '+')) fault.duration_ns = parse_duration_ns(*text, "duration");
  if (const auto text = cut(rest, '@')) fault.from_ns = parse_duration_ns(*text, "from");
  const auto value = cut(rest, '=');
  if (value) fault.value = static_cast<std::uint32_t>(parse_integer(*value, "value", 0, 0xFFFF'FFFF));
  const std::size_t colon = rest.find(':');
  if (colon == std::string_view::npos) {
    throw std::invalid_argument("\"" + std::string(spec) +
                                "\" is not KIND:UNIT[.INDEX][=VALUE][@FROM][+DURATION]");
  }
  fault.kind = kind_of(rest.substr(0, colon));
  rest.remove_prefix(colon + 1);
  const auto index = cut(rest, '.');
  fault.unit = static_cast<int>(parse_integer(rest, "unit", 1, kUnits));
  if (index) fault.index = index_of(*index, fault.kind, fault.unit);
  if (!index && !names_of(fault.kind).empty()) {
    throw std::invalid_argument(std::string(name_of(fault.kind)) + " needs an index: UNIT.INDEX");
  }
  const bool valued = fault.kind == FaultKind::sensor_stuck || fault.kind == FaultKind::register_stuck ||
                      fault.kind == FaultKind::code_wrong;
  if (valued != value.has_value()) {
    throw std::invalid_argument(std::string(name_of(fault.kind)) +
                                (valued ? " needs a value: =VALUE" : " takes no value"));
  }
  return fault;
}

}  // namespace stationd::plant

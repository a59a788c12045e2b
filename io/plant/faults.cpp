#include "io/plant/faults.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace stationd::plant {

namespace {

constexpr std::array<std::string_view, 11> kNames = {
    "sensor_stuck",   "register_stuck",  "actuator_jammed", "arm_jammed_between",
    "magazine_empty", "code_unreadable", "code_wrong",      "pallet_lost",
    "part_lost",      "part_off_pallet", "infeed_stops"};

struct Limits {
  std::uint32_t index_max;
  std::uint32_t value_max;
};

Limits limits_of(FaultKind kind, int unit) noexcept {
  constexpr std::uint32_t kAny = 0xFFFF'FFFF;
  switch (kind) {
    case FaultKind::sensor_stuck: return {kDiscreteInputs - 1, 1};
    case FaultKind::register_stuck: return {kInputRegisters - 1, 0xFFFF};
    case FaultKind::actuator_jammed: return {kCoils - 1, kAny};
    case FaultKind::magazine_empty: return {unit == 2 ? 3U : 1U, kAny};
    case FaultKind::pallet_lost: return {2, kAny};
    case FaultKind::part_off_pallet: return {kParts - 1, kAny};
    case FaultKind::arm_jammed_between:
    case FaultKind::code_unreadable:
    case FaultKind::code_wrong:
    case FaultKind::part_lost:
    case FaultKind::infeed_stops: return {0, kAny};
  }
  return {0, 0};
}

void act(UnitFaults& unit, const Fault& fault) noexcept {
  const std::uint32_t bit = 1U << fault.index;
  switch (fault.kind) {
    case FaultKind::sensor_stuck:
      unit.stuck_mask |= bit;
      unit.stuck_value = fault.value != 0 ? unit.stuck_value | bit : unit.stuck_value & ~bit;
      break;
    case FaultKind::register_stuck:
      unit.register_mask |= bit;
      unit.register_value[fault.index] = static_cast<std::uint16_t>(fault.value);
      break;
    case FaultKind::actuator_jammed: unit.jam_mask |= bit; break;
    case FaultKind::arm_jammed_between: unit.arm_jammed = true; break;
    case FaultKind::magazine_empty: unit.empty_mask |= bit; break;
    case FaultKind::code_unreadable: unit.code_unreadable = true; break;
    case FaultKind::code_wrong:
      unit.code_wrong = true;
      unit.code = fault.value;
      break;
    case FaultKind::infeed_stops: unit.infeed_stops = true; break;
    case FaultKind::pallet_lost:
    case FaultKind::part_lost:
    case FaultKind::part_off_pallet: break;  // these happen once
  }
}

}  // namespace

std::string_view name_of(FaultKind kind) noexcept { return kNames[static_cast<std::size_t>(kind)]; }

Fault FaultTable::checked(const Fault& fault) {
  const std::string name(name_of(fault.kind));
  if (fault.unit < 1 || fault.unit > kUnits) {
    throw std::invalid_argument(name + ": unit " + std::to_string(fault.unit) + " is not one of 1 to 4");
  }
  const Limits limits = limits_of(fault.kind, fault.unit);
  if (fault.index > limits.index_max) {
    throw std::invalid_argument(name + ": index " + std::to_string(fault.index) + " is above " +
                                std::to_string(limits.index_max));
  }
  if (fault.value > limits.value_max) {
    throw std::invalid_argument(name + ": value " + std::to_string(fault.value) + " is above " +
                                std::to_string(limits.value_max));
  }
  if (fault.from_ns < 0 || fault.duration_ns < 0) throw std::invalid_argument(name + ": a time below zero");
  if (fault.kind == FaultKind::infeed_stops && fault.unit != 1) {
    throw std::invalid_argument(name + ": only unit 1 has an infeed");
  }
  return fault;
}

int FaultTable::add(const Fault& fault) {
  entries_.push_back({++last_id_, checked(fault)});
  return last_id_;
}

void FaultTable::clear(int id) noexcept {
  std::erase_if(entries_, [id](const Entry& entry) { return entry.id == id; });
  if (entries_.empty()) active_ = {};
}

void FaultTable::clear_all() noexcept {
  entries_.clear();
  active_ = {};
}

bool FaultTable::clear_kind(int unit, FaultKind kind) noexcept {
  const auto is = [&](const Entry& entry) { return entry.fault.unit == unit && entry.fault.kind == kind; };
  const bool found = std::erase_if(entries_, is) != 0;
  if (entries_.empty()) active_ = {};
  return found;
}

void FaultTable::update(std::int64_t now_ns) noexcept {
  if (entries_.empty()) return;
  active_ = {};
  const auto over = [now_ns](const Entry& entry) {
    return entry.fault.duration_ns != 0 && now_ns >= entry.fault.from_ns + entry.fault.duration_ns;
  };
  std::erase_if(entries_, over);
  for (const Entry& entry : entries_) {
    if (now_ns < entry.fault.from_ns) continue;
    act(active_[static_cast<std::size_t>(entry.fault.unit - 1)], entry.fault);
  }
}

}  // namespace stationd::plant

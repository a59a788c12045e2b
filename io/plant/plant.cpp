#include "io/plant/plant.hpp"

#include <cassert>
#include <stdexcept>

namespace stationd::plant {

namespace {

constexpr std::int64_t kStepMin = 100'000;
constexpr std::int64_t kStepMax = 100'000'000;

std::size_t index_of(int unit) noexcept {
  assert(unit >= 1 && unit <= kUnits);
  return static_cast<std::size_t>(unit - 1);
}

/// splitmix64: one word of state, so that a saved plant goes on with the same pallets.
std::uint64_t draw(std::uint64_t& state) noexcept {
  state += 0x9E3779B97F4A7C15U;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31);
}

}  // namespace

std::vector<PieceType> PlantConfig::default_types() {
  return {{101, {1, 1, 1, 1}, 300'000'000, 1},
          {102, {2, 1, 2, 2}, 500'000'000, 2},
          {103, {1, 2, 2, 1}, 400'000'000, 1}};
}

Plant::Plant(PlantConfig config) : config_(std::move(config)), ledger_(config_.types), random_(config_.seed) {
  if (config_.types.empty()) throw std::invalid_argument("plant: no types of piece");
  if (config_.step_ns < kStepMin || config_.step_ns > kStepMax) {
    throw std::invalid_argument("plant: a step of " + std::to_string(config_.step_ns) +
                                " ns is not 100 us to 100 ms");
  }
  const MotionTimes& times = config_.times;
  for (const std::int64_t time :
       {times.entry_ns, times.transfer_ns, times.leave_ns, times.infeed_ns, times.outfeed_ns,
        times.entry_stopper_ns, times.stopper_ns, times.clamp_ns, times.gripper_ns, times.arm_height_ns,
        times.arm_pitch_ns, times.press_ns, times.code_read_ns}) {
    if (time < 1) throw std::invalid_argument("plant: a motion time below 1 ns");
  }
  for (int unit = 1; unit <= kUnits; ++unit) stations_[index_of(unit)].set_up(unit, config_);
  refresh_inputs();
}

UnitIo& Plant::unit(int number) noexcept { return stations_[index_of(number)].io; }
const UnitIo& Plant::unit(int number) const noexcept { return stations_[index_of(number)].io; }
const Station& Plant::station(int unit) const noexcept { return stations_[index_of(unit)]; }

void Plant::note_write(int unit) noexcept { stations_[index_of(unit)].unwritten_ns = 0; }

void Plant::de_energise(int unit) noexcept {
  auto& coils = stations_[index_of(unit)].io.coils;
  const bool grips = coils[co::gripper_close];
  coils.fill(false);
  coils[co::gripper_close] = grips;
}

void Plant::step() {
  now_ns_ += config_.step_ns;
  if (!faults_.empty()) {
    faults_.update(now_ns_);
    step_once_faults();
  }
  if (config_.watchdog_ns != 0) step_watchdogs();
  step_outfeed();
  for (int unit = kUnits; unit >= 1; --unit) {
    Station& station = stations_[index_of(unit)];
    TrackSlot& next = unit == kUnits ? outfeed_ : stations_[index_of(unit + 1)].entry;
    step_operator(station, faults_.of(unit));
    station.step({config_, ledger_, faults_.of(unit), next, now_ns_});
  }
  step_infeed();
  refresh_inputs();
}

void Plant::advance_to(std::int64_t until_ns) {
  while (now_ns_ + config_.step_ns <= until_ns) step();
}

void Plant::refresh_inputs() noexcept {
  for (int unit = 1; unit <= kUnits; ++unit) {
    const TrackSlot& next = unit == kUnits ? outfeed_ : stations_[index_of(unit + 1)].entry;
    stations_[index_of(unit)].refresh_inputs(faults_.of(unit), !next.taken());
  }
}

void Plant::step_infeed() {
  TrackSlot& entry = stations_[0].entry;
  const bool more = config_.pallets == 0 || entered_ < config_.pallets;
  if (entry.taken() || !more || faults_.of(1).infeed_stops) {
    infeed_wait_ns_ = 0;
    return;
  }
  infeed_wait_ns_ += config_.step_ns;
  if (infeed_wait_ns_ < config_.times.infeed_ns) return;
  const std::uint64_t drawn =
      draw(random_);  // drawn for listed codes too: a list does not shift what comes after it
  const std::uint32_t code = entered_ < config_.codes.size()
                                 ? config_.codes[entered_]
                                 : config_.types[drawn % config_.types.size()].code;
  entry = {};
  entry.pallet.number = ledger_.open(code, now_ns_).number;
  entry.pallet.code = code;
  ++entered_;
}

void Plant::step_outfeed() {
  if (!outfeed_.taken()) return;
  outfeed_.travel_ns += config_.step_ns;
  if (outfeed_.travel_ns < config_.times.outfeed_ns) return;
  ledger_.record(outfeed_.pallet.number).left_ns = now_ns_;
  outfeed_ = {};
}

void Plant::step_watchdogs() {
  for (int unit = 1; unit <= kUnits; ++unit) {
    Station& station = stations_[index_of(unit)];
    if (station.unwritten_ns < 0) continue;
    station.unwritten_ns += config_.step_ns;
    if (station.unwritten_ns < config_.watchdog_ns) continue;
    de_energise(unit);
    station.unwritten_ns = -1;
  }
}

void Plant::step_operator(Station& station, const UnitFaults& faults) {
  const std::uint16_t full = station.is_storage() ? config_.shelf_capacity : config_.magazine_capacity;
  for (std::size_t i = 0; i < station.feeder_count(); ++i) {
    Feeder& feeder = station.feeders[i];
    const bool blocked = ((faults.empty_mask >> i) & 1U) != 0;
    if (blocked) feeder.level = 0;
    if (blocked || !config_.automatic_operator || feeder.level > config_.operator_threshold) {
      feeder.low_for_ns = 0;
      continue;
    }
    feeder.low_for_ns += config_.step_ns;
    if (feeder.low_for_ns < config_.operator_delay_ns) continue;
    feeder.level = full;
    feeder.low_for_ns = 0;
  }
}

// --- faults ---

int Plant::inject(const Fault& fault) { return faults_.add(fault); }
void Plant::clear(int id) noexcept { faults_.clear(id); }
void Plant::clear_faults() noexcept { faults_.clear_all(); }

void Plant::step_once_faults() {
  faults_.once(now_ns_, [this](const Fault& fault) {
    Station& station = stations_[index_of(fault.unit)];
    if (fault.kind == FaultKind::pallet_lost) {
      return take_pallet(station.slot(static_cast<Zone>(fault.index)));
    }
    if (fault.kind == FaultKind::part_lost) return take_held(station);
    return take_part_off(station.position.pallet, fault.index);
  });
}

bool Plant::take_pallet(TrackSlot& slot) {
  if (!slot.taken()) return false;
  ledger_.record(slot.pallet.number).removed_ns = now_ns_;
  slot = {};
  return true;
}

bool Plant::take_held(Station& station) {
  if (station.held.grip == Grip::nothing) return false;
  if (station.held.grip == Grip::piece) {
    ledger_.record(station.held.piece.number).removed_ns = now_ns_;
  } else {
    ledger_.part_removed();
  }
  station.held = {};
  return true;
}

bool Plant::take_part_off(Pallet& pallet, std::size_t lowest) {
  if (pallet.number == 0 || pallet.variant[lowest] == 0) return false;
  PalletRecord& record = ledger_.record(pallet.number);
  for (std::size_t part = lowest; part < kParts && pallet.variant[part] != 0; ++part) {
    pallet.variant[part] = record.variant[part] = 0;
    ledger_.part_removed();
  }
  pallet.seated = false;
  pallet.pressed_ns = 0;
  record.seated_ns = -1;
  return true;
}

// --- the operator's hands ---

bool Plant::operator_removes_from_gripper(int unit) {
  const bool done = take_held(stations_[index_of(unit)]);
  refresh_inputs();
  return done;
}

bool Plant::operator_removes_pallet(int unit, Zone zone) {
  assert(zone != Zone::outfeed || unit == kUnits);
  const bool done = take_pallet(zone == Zone::outfeed ? outfeed_ : stations_[index_of(unit)].slot(zone));
  refresh_inputs();
  return done;
}

bool Plant::operator_removes_part(int unit, Part lowest) {
  const bool done =
      take_part_off(stations_[index_of(unit)].position.pallet, static_cast<std::size_t>(lowest));
  refresh_inputs();
  return done;
}

bool Plant::operator_frees_arm(int unit) {
  const bool jammed = faults_.clear_kind(unit, FaultKind::arm_jammed_between);
  stations_[index_of(unit)].bring_arm_home();
  refresh_inputs();
  return jammed;
}

void Plant::operator_refills(int unit) {
  Station& station = stations_[index_of(unit)];
  const std::uint16_t full = station.is_storage() ? config_.shelf_capacity : config_.magazine_capacity;
  for (std::size_t i = 0; i < station.feeder_count(); ++i) station.feeders[i].level = full;
  refresh_inputs();
}

void Plant::operator_sets_level(int unit, std::size_t feeder, std::uint16_t level) {
  Station& station = stations_[index_of(unit)];
  assert(feeder < station.feeder_count());
  station.feeders[feeder].level = level;
  refresh_inputs();
}

std::uint32_t Plant::pallet_in(int unit, Zone zone) const noexcept {
  if (zone == Zone::outfeed) return unit == kUnits ? outfeed_.pallet.number : 0;
  const Station& station = stations_[index_of(unit)];
  const TrackSlot& slot = zone == Zone::entry      ? station.entry
                          : zone == Zone::transfer ? station.transfer
                                                   : station.position;
  return slot.pallet.number;
}

}  // namespace stationd::plant

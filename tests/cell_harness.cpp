#include "tests/cell_harness.hpp"

#include <algorithm>

#include "programs/programs.hpp"
#include "scan/codes.hpp"

namespace stationd::test {
namespace {

constexpr std::int64_t kInputsStale_ns = 50 * kMs, kInputsBad_ns = 500 * kMs;
constexpr std::int64_t kBusStale_ns = 500 * kMs, kBusBad_ns = 1500 * kMs;
constexpr std::int64_t kOutputsStay_ns = 400 * kMs;  // the unit's own watchdog, see docs/cell.md
constexpr std::int64_t kOperatorDelay_ns = 2 * kSecond;
constexpr std::uint64_t kRetainIntervalScans = 100;

const std::vector<std::string> kCommonInputs = {
    "pallet_at_entry",       "pallet_in_transfer",      "pallet_in_position", "next_entry_clear",
    "entry_stopper_is_open", "entry_stopper_is_closed", "stopper_is_open",    "stopper_is_closed",
    "clamp_is_closed",       "clamp_is_open",           "arm_is_up",          "arm_is_down",
    "gripper_is_open",       "gripper_is_closed",       "part_in_gripper",    "code_valid"};
const std::array<std::vector<std::string>, 4> kOwnInputs = {
    {{"base_present"},
     {"bearing_present", "shaft_present"},
     {"lid_present", "press_is_up", "press_is_down", "lid_seated"},
     {"piece_present", "place_occupied"}}};
const std::array<std::vector<std::string>, 4> kRegisters = {
    {{"base_1_level", "base_2_level"},
     {"bearing_1_level", "bearing_2_level", "shaft_1_level", "shaft_2_level"},
     {"lid_1_level", "lid_2_level"},
     {"shelf_1_free", "shelf_2_free"}}};
const std::vector<std::string> kCoils = {"conveyor",  "entry_stopper_open", "stopper_open", "clamp_close",
                                         "read_code", "arm_enable",         "arm_down",     "gripper_close"};
constexpr std::size_t kGripperCoil = plant::co::gripper_close;

std::vector<Recipe> recipes() {
  const auto one = [](std::uint32_t code, std::int64_t base, std::int64_t bearing, std::int64_t shaft,
                      std::int64_t lid, std::int64_t press_ms, std::int64_t shelf) {
    return Recipe{code,
                  "type " + std::to_string(code),
                  {{"base", base},
                   {"bearing", bearing},
                   {"shaft", shaft},
                   {"lid", lid},
                   {"press_time", press_ms * kMs},
                   {"shelf", shelf}}};
  };
  return {one(101, 1, 1, 1, 1, 300, 1), one(102, 2, 1, 2, 2, 500, 2), one(103, 1, 2, 2, 1, 400, 1)};
}

ProgramOptions program_options(int unit) {
  ProgramOptions options;
  const auto at = static_cast<std::size_t>(unit - 1);
  options.station = kStationNames[at];
  if (at > 0) options.upstream = kStationNames[at - 1];
  if (at < 3) options.downstream = kStationNames[at + 1];
  options.recipes = recipes();
  return options;
}

plant::PlantConfig plant_config(const CellOptions& options) {
  plant::PlantConfig config;
  config.seed = options.seed;
  config.pallets = options.pallets;
  config.step_ns = options.plant_step_ns;
  config.codes = options.codes;
  return config;
}

}  // namespace

CellHarness::CellHarness(CellOptions options)
    : options_(std::move(options)), plant_(plant_config(options_)), random_(options_.seed) {
  for (int unit = 1; unit <= 4; ++unit) {
    units_[index(unit)].name = kStationNames[index(unit)];
    revive(unit);
  }
}

std::set<std::uint32_t> CellHarness::all_steps(const std::string& program) {
  const auto at = std::find(kStationNames.begin(), kStationNames.end(), program) - kStationNames.begin();
  const auto made = make_program(program, program_options(static_cast<int>(at) + 1));
  std::set<std::uint32_t> steps;
  for (std::uint32_t step = 0; step < 1000; ++step)
    if (!made->step_name(step).empty()) steps.insert(step);
  return steps;
}

void CellHarness::revive(int number, bool cold) {
  Unit& unit = units_[index(number)];
  StationOptions options;
  options.name = unit.name;
  options.epoch = ++unit.epoch;
  unit.station = std::make_unique<Station>(options, make_program(unit.name, program_options(number)));
  std::vector<std::string> inputs = kCommonInputs;
  const auto& own = kOwnInputs[index(number)];
  const auto& registers = kRegisters[index(number)];
  inputs.insert(inputs.end(), own.begin(), own.end());
  unit.readers.clear();
  for (std::size_t i = 0; i < inputs.size(); ++i)
    unit.readers.emplace_back([i](const plant::UnitIo& io) { return Slot{io.discrete_inputs[i]}; });
  inputs.insert(inputs.end(), {"pallet_code", "arm_position"});
  unit.readers.emplace_back([](const plant::UnitIo& io) { return Slot{io.pallet_code()}; });
  for (std::size_t i = plant::ir::arm_position; i < plant::ir::level_first + registers.size(); ++i)
    unit.readers.emplace_back([i](const plant::UnitIo& io) { return Slot{io.input_registers[i]}; });
  inputs.insert(inputs.end(), registers.begin(), registers.end());
  unit.station->add_device_inputs("unit", inputs, kInputsStale_ns, kInputsBad_ns);
  std::vector<std::string> outputs = kCoils;
  if (number == kSealer) outputs.emplace_back("press_down");
  outputs.emplace_back("arm_target");
  unit.station->add_device_outputs("unit", outputs);
  unit.station->set_bus_limits(kBusStale_ns, kBusBad_ns);
  unit.station->seal();
  if (cold) unit.has_disk = false;
  if (unit.has_disk) unit.station->restore(unit.disk);
  unit.track_step = unit.station->image().value(*unit.station->image().find("track_step"));
  unit.arm_step = unit.station->image().value(*unit.station->image().find("arm_step"));
  unit.scan = unit.last_saved = 0;
  unit.writing = unit.permitted = false;
  unit.safe_block = 0;
  unit.drop_at_ns = -1;
  unit.fault_since_ns = -1;
  plant_.de_energise(number);
}

void CellHarness::kill(int number, AfterDeath after, bool last_write_made_it) {
  Unit& unit = units_[index(number)];
  if (unit.writing && last_write_made_it) {
    unit.disk = unit.write.slots;
    unit.has_disk = true;
  }
  unit.writing = false;
  unit.station.reset();
  unit.track_step = unit.arm_step = nullptr;
  unit.drop_at_ns = now_ns_ + (after == AfterDeath::stay_a_while ? kOutputsStay_ns : 0);
}

std::uint32_t CellHarness::step_tag(int number, const char* name) const {
  const Unit& unit = units_[index(number)];
  if (unit.station == nullptr) return 0;
  return static_cast<std::uint32_t>(std::string_view(name) == "track_step" ? *unit.track_step
                                                                           : *unit.arm_step);
}

void CellHarness::feed_inputs(int number) {
  Unit& unit = units_[index(number)];
  if (unit.cut) return;
  InputLink& link = *unit.station->device_inputs().front();
  const BlockView block{link.blocks.writable(), link.tags.layout};
  const plant::UnitIo& io = plant_.unit(number);
  for (std::size_t i = 0; i < unit.readers.size(); ++i) {
    block.slots()[i] = unit.readers[i](io);
    block.qualities()[i] = Quality::GOOD;
  }
  block.header() = {};
  block.header().time_ns = now_ns_;
  block.header().count = ++unit.inputs_count;
  block.header().quality = Quality::GOOD;
  link.blocks.publish();
}

void CellHarness::drive_outputs(int number) {
  Unit& unit = units_[index(number)];
  OutputLink& link = *unit.station->device_outputs().front();
  link.blocks.update();
  if (unit.cut) return;
  plant::UnitIo& io = plant_.unit(number);
  const ConstBlockView block{link.blocks.readable(), link.tags.layout};
  // As io/device_rules does: only a block that was committed after the permit was seen stands.
  const bool permitted = unit.station->port().permit.load();
  if (!permitted || !unit.permitted) unit.safe_block = block.header().count;
  unit.permitted = permitted;
  if (block.header().count <= unit.safe_block) return plant_.de_energise(number);
  const std::size_t coils = number == kSealer ? kCoils.size() + 1 : kCoils.size();
  for (std::size_t i = 0; i < coils; ++i) io.coils[i] = block.slots()[i] != 0;
  io.holding_registers[plant::hr::arm_target] = static_cast<std::uint16_t>(block.slots()[coils]);
  static_assert(kGripperCoil == 7);
}

/// One write at a time, as a thread with one file would; urgent ones at once, others after the retain
/// interval.
void CellHarness::serve_retain(Unit& unit) const {
  RetainLink& link = unit.station->retain();
  if (unit.writing && unit.scan >= unit.write.done_at) {
    unit.writing = false;
    unit.disk = unit.write.slots;
    unit.has_disk = true;
    unit.last_saved = unit.scan;
    link.saved_scan.store(unit.write.scan);
  }
  if (unit.writing) return;
  const bool urgent = link.urgent_scan.load() > link.saved_scan.load();
  if (!urgent && unit.scan - unit.last_saved < kRetainIntervalScans) return;
  if (!link.blocks.update()) return;
  const ConstBlockView block{link.blocks.readable(), link.tags.layout};
  unit.write = {{block.slots().begin(), block.slots().end()},
                block.header().scan,
                unit.scan + options_.commit_after_scans};
  unit.writing = true;
}

bool CellHarness::lost() {
  return options_.samples_lost > 0 && std::uniform_real_distribution<>(0, 1)(random_) < options_.samples_lost;
}

void CellHarness::deliver(const std::string& source, const std::vector<std::string>& members,
                          const std::vector<Slot>& values) {
  for (Unit& unit : units_) {
    if (unit.station == nullptr || source == withheld_) continue;
    for (auto& link : unit.station->bus_inputs()) {
      if (link->source != source || lost()) continue;
      const BlockView block{link->blocks.writable(), link->tags.layout};
      for (std::size_t i = 0; i < link->members.size(); ++i) {
        const auto at = std::find(members.begin(), members.end(), link->members[i]) - members.begin();
        block.slots()[i] = values[static_cast<std::size_t>(at)];
        block.qualities()[i] = Quality::GOOD;
      }
      block.header() = {};
      block.header().time_ns = now_ns_;
      block.header().count = ++deliveries_;
      block.header().quality = Quality::GOOD;
      link->blocks.publish();
    }
  }
}

void CellHarness::count_end(Unit& unit, const PvLink& pv, ConstBlockView block) {
  std::map<std::string, Slot> member;
  for (std::size_t i = 0; i < pv.members.size(); ++i) member[pv.members[i]] = block.slots()[i];
  if (member["CODE"] != 0) unit.ended[member["ERROR"] != 0 ? 1 : 0].insert({member["EPOCH"], member["SEQ"]});
}

void CellHarness::serve_bus(int number) {
  Unit& unit = units_[index(number)];
  for (auto& pv : unit.station->pvs()) {
    if (!pv->blocks.update()) continue;
    const ConstBlockView block{pv->blocks.readable(), pv->tags.layout};
    if (pv->topic == "End") count_end(unit, *pv, block);
    deliver(pv->topic + "/" + unit.name, pv->members, {block.slots().begin(), block.slots().end()});
  }
  StatusRecord status;
  if (!unit.station->port().status.take(status) || unit.scan % 5 != 0) return;
  deliver("Status/" + unit.name, {"STATE", "READY"},
          {static_cast<Slot>(status.state), static_cast<Slot>(status.ready)});
}

void CellHarness::collect_events(Unit& unit) {
  Event event;
  while (unit.station->port().events.pop(event))
    if (event.active) ++unit.raised[event.code];
}

void CellHarness::scan() {
  now_ns_ += options_.scan_ns;
  for (int number = 1; number <= 4; ++number) {
    Unit& unit = units_[index(number)];
    if (unit.drop_at_ns < 0 || now_ns_ < unit.drop_at_ns) continue;
    plant_.de_energise(number);
    unit.drop_at_ns = -1;
  }
  plant_.advance_to(now_ns_);
  for (int number = 1; number <= 4; ++number) {
    Unit& unit = units_[index(number)];
    if (unit.station == nullptr) continue;
    feed_inputs(number);
    Station& station = *unit.station;
    station.begin(now_ns_, ++unit.scan, 0);
    station.latch();
    station.execute();
    station.commit();
    station.publish(0);
    station.service_one();
    drive_outputs(number);
    serve_retain(unit);
    serve_bus(number);
    collect_events(unit);
    if (station.state() == StationState::STOPPED || station.state() == StationState::FAULT) continue;
    unit.visited.insert(static_cast<std::uint32_t>(*unit.track_step));
    unit.visited.insert(static_cast<std::uint32_t>(*unit.arm_step));
  }
  act_as_people();
}

void CellHarness::start(int unit) {
  Request request;
  request.order = ++orders_;
  request.verb = Verb::start;
  station(unit).port().requests.push(request);
}

void CellHarness::stop(int unit, StopMode mode) { station(unit).port().stop.set(mode, ++orders_); }

void CellHarness::reset(int unit) {
  Request request;
  request.order = ++orders_;
  request.verb = Verb::reset;
  station(unit).port().requests.push(request);
}

StationState CellHarness::state(int unit) const {
  const Unit& of = units_[index(unit)];
  return of.station == nullptr ? StationState::STOPPED : of.station->state();
}

void CellHarness::act_as_people() {
  for (int number = 1; number <= 4; ++number) {
    Unit& unit = units_[index(number)];
    if (unit.station == nullptr) continue;
    const StationState state = unit.station->state();
    if (state == StationState::FAULT) {
      if (unit.fault_since_ns < 0) unit.fault_since_ns = now_ns_;
      if (!operator_acts || now_ns_ - unit.fault_since_ns < kOperatorDelay_ns) continue;
      answer(number, unit.station->active_fault());
      reset(number);
      unit.fault_since_ns = now_ns_;
    } else {
      unit.fault_since_ns = -1;
    }
    if (state == StationState::STOPPED && keep_running[index(number)] && unit.scan % 20 == 10) start(number);
  }
}

/// What a sensible person does who was asked that question.
void CellHarness::answer(int unit, std::uint32_t asked) {
  if (operator_repairs) plant_.clear_faults();
  switch (asked) {
    case code::gripper_unknown_part:
    case code::gripper_wrong_part: plant_.operator_removes_from_gripper(unit); break;
    case code::transfer_occupied: plant_.operator_removes_pallet(unit, plant::Zone::transfer); break;
    case code::arm_sideways_jammed: plant_.operator_frees_arm(unit); break;
    default: break;
  }
}

bool CellHarness::all_pallets_done() const {
  const plant::Verdict verdict = plant_.ledger().verdict();
  return verdict.pallets >= options_.pallets && verdict.in_cell == 0;
}

bool CellHarness::run_until(const std::function<bool()>& done, std::int64_t at_most_ns) {
  const std::int64_t until_ns = now_ns_ + at_most_ns;
  while (now_ns_ < until_ns) {
    scan();
    if (done()) return true;
  }
  return false;
}

bool CellHarness::run_out(std::int64_t at_most_ns) {
  const bool out = run_until([this] { return all_pallets_done(); }, at_most_ns);
  run_until([] { return false; }, 5 * kSecond);  // the last End, the last empty pallet
  return out;
}

std::string CellHarness::complaint() const {
  const plant::Verdict v = plant_.ledger().verdict();
  std::string text;
  const auto say = [&text](bool wrong, const char* what, std::uint32_t count) {
    if (wrong) text += std::string(what) + " " + std::to_string(count) + "; ";
  };
  say(v.pallets < options_.pallets, "pallets entered only", v.pallets);
  say(v.in_cell != 0, "still in the cell", v.in_cell);
  say(v.stored_wrong != 0, "stored wrong", v.stored_wrong);
  say(v.stored_twice != 0, "stored twice", v.stored_twice);
  say(v.left_unstored != 0, "left unstored", v.left_unstored);
  say(v.doubles != 0, "doubles", v.doubles);
  say(v.dropped_parts != 0, "dropped parts", v.dropped_parts);
  say(v.dropped_pieces != 0, "dropped pieces", v.dropped_pieces);
  say(v.stored_right + v.removed != v.pallets, "stored right", v.stored_right);
  say(ended(kStorage, false) != v.stored, "Ends of storage",
      static_cast<std::uint32_t>(ended(kStorage, false)));
  for (const plant::Violation& violation : plant_.ledger().violations())
    text += std::string(plant::name_of(violation.kind)) + " at unit " + std::to_string(violation.unit) +
            ", " + std::to_string(violation.at_ns / kMs) + " ms; ";
  if (!text.empty()) {
    for (const Unit& unit : units_) {
      text += "\n  " + unit.name + ": ";
      if (unit.station == nullptr)
        text += "dead";
      else
        text += std::string(name_of(unit.station->state())) + ", track " + std::to_string(*unit.track_step) +
                ", arm " + std::to_string(*unit.arm_step) + ", fault " +
                std::to_string(unit.station->active_fault());
      for (const auto& [raised_code, count] : unit.raised)
        text += " [" + std::to_string(raised_code) + " x" + std::to_string(count) + "]";
    }
  }
  return text;
}

int CellHarness::faults_raised() const {
  int total = 0;
  for (const Unit& unit : units_)
    for (const auto& [raised_code, count] : unit.raised) {
      const CodeInfo* info = find_code(raised_code);
      if (info != nullptr && info->severity == Severity::fault) total += count;
    }
  return total;
}

}  // namespace stationd::test

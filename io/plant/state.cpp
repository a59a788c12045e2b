// Plant::save and Plant::load: one list of values, visited by a writer or by a reader, with a checksum behind
// it.
#include <charconv>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "io/plant/plant.hpp"

namespace stationd::plant {

namespace {

constexpr std::string_view kTitle = "stationd-plant-state 1\n";

std::uint64_t checksum(std::string_view text) noexcept {
  std::uint64_t hash = 0xCBF29CE484222325U;  // FNV-1a
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
  return hash;
}

class Writer {
 public:
  static constexpr bool kReads = false;
  template <class T> void operator()(T& value) {
    (text_ += std::to_string(static_cast<std::int64_t>(value))) += ' ';
  }
  void line() { text_.back() = '\n'; }
  std::string text_{kTitle};
};

class Reader {
 public:
  static constexpr bool kReads = true;
  explicit Reader(std::string_view text) : rest_(text) {}
  template <class T> void operator()(T& value) {
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), number);
    if (error != std::errc{}) throw std::runtime_error("plant state: a value is missing or no number");
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()) +
                        (end != rest_.data() + rest_.size() ? 1U : 0U));
    value = static_cast<T>(number);
  }
  void line() {}
  bool done() const noexcept { return rest_.empty(); }

 private:
  std::string_view rest_;
};

template <class Archive> void visit_each(Archive& archive, auto& values) {
  for (auto& value : values) archive(value);
}

template <class Archive, class T> void visit_size(Archive& archive, std::vector<T>& values) {
  std::uint64_t size = values.size();
  archive(size);
  if (size > 100'000'000) throw std::runtime_error("plant state: a list too long");
  if constexpr (Archive::kReads) values.resize(size);
}

template <class Archive> void visit_pallet(Archive& archive, Pallet& pallet) {
  archive(pallet.number);
  archive(pallet.code);
  visit_each(archive, pallet.variant);
  archive(pallet.pressed_ns);
  archive(pallet.seated);
}

template <class Archive> void visit_slot(Archive& archive, TrackSlot& slot) {
  visit_pallet(archive, slot.pallet);
  archive(slot.travel_ns);
}

template <class Archive> void visit_record(Archive& archive, PalletRecord& record) {
  archive(record.number);
  archive(record.code);
  archive(record.entered_ns);
  visit_each(archive, record.variant);
  visit_each(archive, record.placed_ns);
  archive(record.doubles);
  archive(record.seated_ns);
  archive(record.picked_ns);
  archive(record.stored_ns);
  archive(record.times_stored);
  archive(record.shelf);
  archive(record.removed_ns);
  archive(record.dropped_ns);
  archive(record.left_ns);
  archive.line();
}

}  // namespace

template <class Archive> void Ledger::visit(Archive& archive) {
  visit_size(archive, pallets_);
  for (PalletRecord& record : pallets_) visit_record(archive, record);
  visit_size(archive, violations_);
  for (Violation& violation : violations_) {
    archive(violation.at_ns);
    archive(violation.kind);
    archive(violation.unit);
    archive(violation.pallet);
  }
  visit_each(archive, by_kind_);
  archive(violations_total_);
  archive(dropped_parts_);
  archive(parts_removed_);
  archive.line();
}

template <class Archive> void Station::visit(Archive& archive) {
  visit_each(archive, io.coils);
  visit_each(archive, io.holding_registers);
  for (TrackSlot* slot : {&entry, &transfer, &position}) visit_slot(archive, *slot);
  for (Axis* axis : {&entry_stopper, &stopper, &clamp, &arm_height, &gripper, &press}) archive(axis->at_ns);
  archive(held.grip);
  archive(held.part);
  archive(held.variant);
  visit_pallet(archive, held.piece);
  for (Feeder& feeder : feeders) {
    archive(feeder.level);
    archive(feeder.low_for_ns);
    visit_pallet(archive, feeder.at_place);
  }
  archive(arm_at_ns);
  archive(flagged_);
  archive.line();
}

template <class Archive> void Plant::visit(Archive& archive) {
  archive(now_ns_);
  archive(random_);
  archive(entered_);
  archive(infeed_wait_ns_);
  visit_slot(archive, outfeed_);
  archive.line();
  for (Station& station : stations_) station.visit(archive);
  ledger_.visit(archive);
}

std::string Plant::save() const {
  Writer writer;
  // The one list of values serves both ways; a Writer changes none of them.
  const_cast<Plant*>(this)->visit(writer);
  return writer.text_ + "end " + std::to_string(checksum(writer.text_)) + "\n";
}

void Plant::load(std::string_view text) {
  const std::size_t end = text.rfind("end ");
  if (!text.starts_with(kTitle)) throw std::runtime_error("plant state: not a state file of this version");
  if (end == std::string_view::npos) throw std::runtime_error("plant state: cut short");
  const std::string_view body = text.substr(0, end);
  if (text.substr(end) != "end " + std::to_string(checksum(body)) + "\n") {
    throw std::runtime_error("plant state: the checksum does not match");
  }
  Plant loaded = *this;
  Reader reader(body.substr(kTitle.size()));
  loaded.visit(reader);
  if (!reader.done()) throw std::runtime_error("plant state: more in it than there should be");
  for (int unit = 1; unit <= kUnits; ++unit) {
    loaded.stations_[static_cast<std::size_t>(unit - 1)].unwritten_ns = -1;
    loaded.de_energise(unit);
  }
  loaded.refresh_inputs();
  *this = std::move(loaded);
}

}  // namespace stationd::plant

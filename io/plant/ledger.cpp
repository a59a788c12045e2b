#include "io/plant/ledger.hpp"

#include <cassert>

namespace stationd::plant {

namespace {

constexpr std::size_t kViolationsKept = 10'000;
constexpr std::size_t kPalletsForeseen = 4'096;

constexpr std::array<std::string_view, kViolationKinds> kViolationNames = {"arm_sideways_while_down",
                                                                           "gripper_opened_astray",
                                                                           "seat_taken",
                                                                           "wrong_order",
                                                                           "arm_down_clamp_open",
                                                                           "press_down_arm_in_way",
                                                                           "press_down_clamp_open",
                                                                           "clamp_holds_moving_pallet",
                                                                           "arm_holds_moving_pallet",
                                                                           "press_holds_moving_pallet",
                                                                           "two_pallets_in_zone"};
constexpr std::array<std::string_view, kParts> kPartNames = {"base", "bearing", "shaft", "lid"};

}  // namespace

std::string_view name_of(ViolationKind kind) noexcept {
  return kViolationNames[static_cast<std::size_t>(kind)];
}
std::string_view name_of(Part part) noexcept { return kPartNames[static_cast<std::size_t>(part)]; }

Ledger::Ledger(std::vector<PieceType> types) : types_(std::move(types)) {
  pallets_.reserve(kPalletsForeseen);
  violations_.reserve(64);
}

PalletRecord& Ledger::open(std::uint32_t code, std::int64_t now_ns) {
  PalletRecord& record = pallets_.emplace_back();
  record.number = static_cast<std::uint32_t>(pallets_.size());
  record.code = code;
  record.entered_ns = now_ns;
  return record;
}

void Ledger::violate(ViolationKind kind, int unit, std::uint32_t pallet, std::int64_t now_ns) {
  ++violations_total_;
  ++by_kind_[static_cast<std::size_t>(kind)];
  if (violations_.size() < kViolationsKept) violations_.push_back({now_ns, kind, unit, pallet});
}

std::uint32_t Ledger::count(ViolationKind kind) const noexcept {
  return by_kind_[static_cast<std::size_t>(kind)];
}

const PieceType* Ledger::type_of(std::uint32_t code) const noexcept {
  for (const PieceType& type : types_) {
    if (type.code == code) return &type;
  }
  return nullptr;
}

bool Ledger::is_right(const PalletRecord& record) const noexcept {
  const PieceType* type = type_of(record.code);
  return type != nullptr && record.variant == type->variant && record.seated_ns >= 0 && record.doubles == 0 &&
         record.times_stored == 1 && record.shelf == type->shelf;
}

Fate Ledger::fate_of(const PalletRecord& record) const noexcept {
  if (record.shelf != 0) return is_right(record) ? Fate::right : Fate::wrong;
  if (record.removed_ns >= 0) return Fate::removed;
  if (record.dropped_ns >= 0) return Fate::dropped;
  // A pallet may leave while storage still holds its piece.
  if (record.left_ns >= 0 && record.picked_ns < 0) return Fate::unstored;
  return Fate::in_cell;
}

Verdict Ledger::verdict() const {
  Verdict v;
  v.pallets = static_cast<std::uint32_t>(pallets_.size());
  v.violations = violations_total_;
  v.dropped_parts = dropped_parts_;
  v.parts_removed = parts_removed_;
  for (const PalletRecord& record : pallets_) {
    v.doubles += record.doubles;
    v.stored_twice += record.times_stored > 1;
    switch (fate_of(record)) {
      case Fate::in_cell: ++v.in_cell; break;
      case Fate::removed: ++v.removed; break;
      case Fate::dropped: ++v.dropped_pieces; break;
      case Fate::unstored: ++v.left_unstored; break;
      case Fate::right:
        ++v.stored;
        ++v.stored_right;
        break;
      case Fate::wrong:
        ++v.stored;
        ++v.stored_wrong;
        count_wrongs(record, v);
        break;
    }
  }
  return v;
}

void Ledger::count_wrongs(const PalletRecord& record, Verdict& v) const noexcept {
  v.unseated += record.seated_ns < 0;
  const PieceType* type = type_of(record.code);
  if (type == nullptr) return;
  v.wrong_shelf += record.shelf != type->shelf;
  for (std::size_t part = 0; part < kParts; ++part) {
    v.missing_parts += record.variant[part] == 0;
    v.wrong_parts += record.variant[part] != 0 && record.variant[part] != type->variant[part];
  }
}

}  // namespace stationd::plant

#include "programs/assembler.hpp"

#include "scan/codes.hpp"

namespace stationd::programs {

Assembler::Seat::Seat(Program& owner, const SeatOptions& options)
    : kind(options.kind), first_feeder(options.first_feeder),
      present(owner, options.name + "_present", "the part is on the pallet in position"),
      level_1(owner, options.name + "_1_level", "parts left in magazine 1"),
      level_2(owner, options.name + "_2_level", "parts left in magazine 2") {}

Assembler::Assembler(const ProgramOptions& options, const Traits& traits,
                     const std::vector<SeatOptions>& seats, bool fetches_ahead)
    : CellStation(options, traits), fetches_ahead_(fetches_ahead) {
  for (std::size_t i = 0; i < seats.size() && i < seats_.size(); ++i) {
    seats_[i].emplace(*this, seats[i]);
    needs({&seats_[i]->present, &seats_[i]->level_1, &seats_[i]->level_2});
  }
}

const Assembler::Seat* Assembler::seat_of(const Errand& errand) const noexcept {
  for (const auto& seat : seats_)
    if (seat && seat->kind == errand.kind) return &*seat;
  return nullptr;
}

Errand Assembler::errand_for(const Seat& seat, const PieceType& type) const noexcept {
  const std::uint8_t variant = type.variant_of(seat.kind);
  return {seat.kind, variant, static_cast<std::uint16_t>(seat.first_feeder + variant - 1), kArmOverPallet};
}

Errand Assembler::wanted(const PieceType& type, bool in_position) const noexcept {
  if (!in_position) return fetches_ahead_ ? errand_for(*seats_[0], type) : Errand{};
  for (const auto& seat : seats_)
    if (seat && !seat->present) return errand_for(*seat, type);
  return {};
}

bool Assembler::source_ready(const Errand& errand) const noexcept {
  const Seat* seat = seat_of(errand);
  return seat != nullptr && (errand.variant == 1 ? seat->level_1 : seat->level_2) > 0;
}

std::uint32_t Assembler::source_warning() const noexcept { return code::magazine_empty; }

bool Assembler::target_free(const Errand& errand) const noexcept {
  for (const auto& seat : seats_) {
    if (!seat) break;
    if (seat->kind == errand.kind) return !seat->present;
    if (!seat->present) return false;  // the part below is missing
  }
  return false;
}

bool Assembler::placed(const Errand& errand) const noexcept {
  const Seat* seat = seat_of(errand);
  return seat != nullptr && seat->present;
}

/// A part on the pallet must be one that this station began to put there, and the other way round.
std::uint32_t Assembler::contradiction(std::uint32_t question) noexcept {
  for (const auto& seat : seats_) {
    if (!seat) break;
    if (seat->present && !placing(seat->kind)) {
      if (question != code::unexpected_part) return code::unexpected_part;
      set_placing(seat->kind, true);
    }
    if (!seat->present && placing(seat->kind) && !carries(seat->kind)) {
      if (question != code::part_lost && question != code::place_failed) return code::part_lost;
      set_placing(seat->kind, false);
    }
  }
  return 0;
}

}  // namespace stationd::programs

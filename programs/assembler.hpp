// Assembler: a cell station that puts parts from magazines onto the piece: loader, robot, sealer.
// Owned by its station.
// Constructed in set-up; the hooks run in the scan thread.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "programs/cell_station.hpp"
#include "scan/nonblocking.hpp"

namespace stationd::programs {

/// One kind of part: where it is fetched, and how it is seen on the pallet.
struct SeatOptions {
  Kind kind = Kind::none;
  std::string name;                ///< "base": tags base_present, base_1_level, base_2_level
  std::uint16_t first_feeder = 0;  ///< arm position of variant 1; variant 2 is the next
};

class Assembler : public CellStation {
 public:
  /// `seats` in the order in which they are filled; at most two.
  Assembler(const ProgramOptions& options, const Traits& traits, const std::vector<SeatOptions>& seats,
            bool fetches_ahead);

 protected:
  Errand wanted(const PieceType& type, bool in_position) const noexcept override;
  bool source_ready(const Errand& errand) const noexcept override;
  std::uint32_t source_warning() const noexcept override;
  bool target_free(const Errand& errand) const noexcept override;
  bool placed(const Errand& errand) const noexcept override;
  std::uint32_t contradiction(std::uint32_t question) noexcept override;

 private:
  struct Seat {
    Seat(Program& owner, const SeatOptions& options);
    Kind kind;
    std::uint16_t first_feeder;
    In<bool> present;
    In<std::uint16_t> level_1, level_2;
  };
  const Seat* seat_of(const Errand& errand) const noexcept STATIOND_NONBLOCKING;
  Errand errand_for(const Seat& seat, const PieceType& type) const noexcept STATIOND_NONBLOCKING;

  std::array<std::optional<Seat>, 2> seats_;
  bool fetches_ahead_;
};

}  // namespace stationd::programs

// Storage: takes the piece off the pallet and puts it on its type's shelf. Last station: the pallet goes to
// the outfeed.
#include "programs/cell_station.hpp"
#include "programs/programs.hpp"
#include "scan/codes.hpp"

namespace stationd::programs {
namespace {

constexpr std::array kKindsHandled = {Kind::piece};

class Storage final : public CellStation {
 public:
  explicit Storage(const ProgramOptions& options)
      : CellStation(options, {kKindsHandled, false}),
        piece_present_(*this, "piece_present", "a piece is on the pallet"),
        place_occupied_(*this, "place_occupied", "a piece stands at the shelf place under the arm"),
        shelf_1_free_(*this, "shelf_1_free", "places free on shelf 1"),
        shelf_2_free_(*this, "shelf_2_free", "places free on shelf 2") {
    needs({&piece_present_, &place_occupied_, &shelf_1_free_, &shelf_2_free_});
  }

 private:
  Errand wanted(const PieceType& type, bool in_position) const noexcept override {
    if (!in_position || piece_stored || piece_status != 0) return {};
    const std::uint8_t shelf = type.variant_of(Kind::piece);
    return {Kind::piece, shelf, kArmOverPallet, static_cast<std::uint16_t>(kArmFirstFeeder + shelf - 1)};
  }

  std::uint16_t free_places(const Errand& errand) const noexcept {
    return errand.variant == 1 ? shelf_1_free_ : shelf_2_free_;
  }

  bool source_ready(const Errand& errand) const noexcept override {
    return piece_present_ && clamp_is_closed && !clamp_is_open && free_places(errand) > 0;
  }
  std::uint32_t source_warning() const noexcept override { return code::shelf_full; }
  bool target_free(const Errand& errand) const noexcept override {
    return !place_occupied_ && free_places(errand) > 0;
  }
  bool target_full(const Errand& errand) const noexcept override {
    return errand.kind == Kind::piece && free_places(errand) == 0;
  }
  bool placed(const Errand& errand) const noexcept override {
    return errand.kind == Kind::piece && place_occupied_;
  }

  std::uint32_t contradiction(std::uint32_t question) noexcept override {
    if (piece_stored || piece_status != 0) return 0;
    if (piece_present_ && part_in_gripper && placing(Kind::piece)) return code::unexpected_part;
    // On its way: the arm's own checks and time-outs hold.
    if (piece_present_ || carries(Kind::piece)) return 0;
    if (question != code::piece_lost) return code::piece_lost;
    piece_status = code::piece_lost;
    return 0;
  }

  /// The one thing that no sensor shows once the arm has moved on.
  void derive(const PieceType* type) noexcept override {
    if (type == nullptr || piece_stored || !placing(Kind::piece) || part_in_gripper) return;
    const Errand errand = wanted(*type, true);
    if (!errand.none() && arm_position == errand.to && place_occupied_ && !piece_present_)
      piece_stored = true;
  }

  In<bool> piece_present_, place_occupied_;
  In<std::uint16_t> shelf_1_free_, shelf_2_free_;
};

}  // namespace

std::unique_ptr<Program> make_storage(const ProgramOptions& options) {
  return std::make_unique<Storage>(options);
}

}  // namespace stationd::programs

// Ledger: what really happened, pallet by pallet; the judge of "every piece once, with the right parts".
// Owned by its Plant.
// The thread that steps the plant; a copy may go anywhere.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/plant/types.hpp"

namespace stationd::plant {

/// Interlocks that docs/cell.md names. Each is counted once per occurrence, not once per step.
enum class ViolationKind : std::uint8_t {
  arm_sideways_while_down,    ///< the arm was to move sideways when not up
  gripper_opened_astray,      ///< the gripper opened with a part where it cannot be put
  seat_taken,                 ///< a part placed on a seat that is taken
  wrong_order,                ///< a part placed before the one below it
  arm_down_clamp_open,        ///< the arm lowered over the pallet while the clamp did not hold
  press_down_arm_in_way,      ///< the press not up and the arm over the pallet
  press_down_clamp_open,      ///< the press lowered while the clamp did not hold
  clamp_holds_moving_pallet,  ///< belt and open stopper drove a pallet that the clamp held
  arm_holds_moving_pallet,    ///< ... that the arm was down on
  press_holds_moving_pallet,  ///< ... that the press was down on
  two_pallets_in_zone         ///< a pallet was driven into a zone that is taken
};
inline constexpr std::size_t kViolationKinds = 11;

/// "arm_sideways_while_down", ...
std::string_view name_of(ViolationKind kind) noexcept;
/// "base", "bearing", "shaft", "lid".
std::string_view name_of(Part part) noexcept;

struct Violation {
  std::int64_t at_ns = 0;
  ViolationKind kind = ViolationKind::arm_sideways_while_down;
  int unit = 0;
  std::uint32_t pallet = 0;  ///< number of the pallet concerned; 0: none
};

/// One pallet's history. Times are plant time, -1: never. Numbers count from 1 in the order of the infeed.
struct PalletRecord {
  std::uint32_t number = 0;
  std::uint32_t code = 0;
  std::int64_t entered_ns = -1;
  std::array<std::uint8_t, kParts> variant{};  ///< by Part; 0: never placed (or fell off)
  std::array<std::int64_t, kParts> placed_ns{-1, -1, -1, -1};
  std::uint32_t doubles = 0;    ///< parts that were put on a seat that was taken
  std::int64_t seated_ns = -1;  ///< the lid was pressed for as long as the type needs
  std::int64_t picked_ns = -1;  ///< storage took the piece off the pallet
  std::int64_t stored_ns = -1;  ///< last time that the piece was put on a shelf
  std::uint32_t times_stored = 0;
  std::uint8_t shelf = 0;        ///< 1, 2; 0: not stored
  std::int64_t removed_ns = -1;  ///< pallet or piece was taken out by hand
  std::int64_t dropped_ns = -1;  ///< the piece was dropped on its way to the shelf
  std::int64_t left_ns = -1;     ///< the pallet left the cell by the outfeed
};

/// Counts over the whole run. A piece is `stored_right` when it was stored once, on its type's shelf, with
/// the parts of its type, the lid seated; every other stored piece is `stored_wrong`, with its reasons
/// counted below.
struct Verdict {
  std::uint32_t pallets = 0;  ///< that came in
  std::uint32_t in_cell = 0;  ///< still on their way
  std::uint32_t stored = 0;
  std::uint32_t stored_right = 0;
  std::uint32_t stored_wrong = 0;
  std::uint32_t stored_twice = 0;   ///< put on a shelf more than once (taken back between)
  std::uint32_t wrong_parts = 0;    ///< parts of another variant than the type's, in stored pieces
  std::uint32_t missing_parts = 0;  ///< parts that stored pieces lack
  std::uint32_t doubles = 0;        ///< parts put on a taken seat
  std::uint32_t unseated = 0;       ///< stored pieces whose lid was not pressed long enough
  std::uint32_t wrong_shelf = 0;
  std::uint32_t left_unstored =
      0;                      ///< pallets that left the cell and whose piece was neither stored nor removed
  std::uint32_t removed = 0;  ///< pallets or pieces taken out by hand, or lost from the gripper by a fault
  std::uint32_t dropped_parts = 0;  ///< parts that the program dropped
  std::uint32_t dropped_pieces = 0;
  std::uint32_t parts_removed = 0;  ///< single parts taken by hand or lost by a fault
  std::uint32_t violations = 0;

  /// Nothing went wrong, whoever was to blame; pallets under way do not count.
  bool clean() const noexcept {
    return stored_wrong == 0 && stored_twice == 0 && left_unstored == 0 && violations == 0 && doubles == 0 &&
           dropped_parts == 0 && dropped_pieces == 0;
  }
  bool operator==(const Verdict&) const = default;
};

/// What became of a pallet's piece.
enum class Fate : std::uint8_t { in_cell, right, wrong, removed, dropped, unstored };

class Ledger {
 public:
  explicit Ledger(std::vector<PieceType> types);

  Verdict verdict() const;
  std::span<const PalletRecord> pallets() const noexcept { return pallets_; }
  /// At most the first 10,000; violations_total() counts them all.
  std::span<const Violation> violations() const noexcept { return violations_; }
  std::uint32_t violations_total() const noexcept { return violations_total_; }
  std::uint32_t count(ViolationKind kind) const noexcept;

  /// The type of a code; null when the plant knows none such.
  const PieceType* type_of(std::uint32_t code) const noexcept;
  /// True when the stored piece is right in everything (see Verdict).
  bool is_right(const PalletRecord& record) const noexcept;
  Fate fate_of(const PalletRecord& record) const noexcept;

  /// The file's content, schema:
  ///   {"time_ms": plant time, "final": bool, "verdict": {every member of Verdict, "clean": bool},
  ///    "violations_by_kind": {name: n},
  ///    "violations": [{"at_ms", "unit", "kind", "pallet"}],
  ///    "pallets": [{"number", "code", "entered_ms", "parts": [{"part", "variant", "at_ms"}], "doubles",
  ///                 "seated_ms", "picked_ms", "stored_ms", "times_stored", "shelf", "removed_ms",
  ///                 "dropped_ms", "left_ms",
  ///                 "fate": "in_cell" | "right" | "wrong" | "removed" | "dropped" | "unstored"}]}
  /// Times are integer milliseconds of plant time, null: never.
  std::string to_json(std::int64_t now_ns, bool final) const;

  // --- for the plant ---
  PalletRecord& open(std::uint32_t code, std::int64_t now_ns);
  PalletRecord& record(std::uint32_t number) { return pallets_.at(number - 1); }
  void violate(ViolationKind kind, int unit, std::uint32_t pallet, std::int64_t now_ns);
  void part_dropped() noexcept { ++dropped_parts_; }
  void part_removed() noexcept { ++parts_removed_; }
  /// Save and load (state.hpp): `archive(value)` for each value.
  template <class Archive> void visit(Archive& archive);

 private:
  void count_wrongs(const PalletRecord& record, Verdict& verdict) const noexcept;

  std::vector<PieceType> types_;
  std::vector<PalletRecord> pallets_;
  std::vector<Violation> violations_;
  std::array<std::uint32_t, kViolationKinds> by_kind_{};
  std::uint32_t violations_total_ = 0;
  std::uint32_t dropped_parts_ = 0;
  std::uint32_t parts_removed_ = 0;
};

}  // namespace stationd::plant

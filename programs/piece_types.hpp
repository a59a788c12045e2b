// PieceTypes: the types of piece of the configuration, in fixed places, as the cell's programs look them up.
// Owned by a program.
// Constructed in set-up (throws SetupError); then read by the scan thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "scan/nonblocking.hpp"
#include "scan/program.hpp"

namespace stationd::programs {

/// What an arm carries. `piece` is the assembled whole.
enum class Kind : std::uint8_t { none = 0, base = 1, bearing = 2, shaft = 3, lid = 4, piece = 5 };
inline constexpr std::size_t kKinds = 6;

struct PieceType {
  std::uint32_t code = 0;
  std::array<std::uint8_t, kKinds> variant{};  ///< by Kind: 1 or 2; `piece`: the shelf
  std::int64_t press_ns = 0;

  std::uint8_t variant_of(Kind kind) const noexcept { return variant[static_cast<std::size_t>(kind)]; }
};

class PieceTypes {
 public:
  static constexpr std::size_t kMax = 32;

  /// Takes the variants of `kinds` ("base", ..., "shelf") and, if asked, "press_time" from every recipe.
  /// Throws SetupError for a missing or impossible value, a code that is 0 or given twice, no recipe, or
  /// more than 32.
  PieceTypes(std::span<const Recipe> recipes, std::span<const Kind> kinds, bool with_press_time);

  /// Null when no type has that code.
  const PieceType* find(std::uint32_t code) const noexcept STATIOND_NONBLOCKING;

 private:
  std::array<PieceType, kMax> types_{};
  std::size_t size_ = 0;
};

}  // namespace stationd::programs

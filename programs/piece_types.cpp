#include "programs/piece_types.hpp"

#include <string>

#include "scan/error.hpp"

namespace stationd::programs {
namespace {

constexpr std::array<std::string_view, kKinds> kValueNames = {"", "base", "bearing", "shaft", "lid", "shelf"};
constexpr std::int64_t kPressMin_ns = 1'000'000;
constexpr std::int64_t kPressMax_ns = 600'000'000'000;

}  // namespace

PieceTypes::PieceTypes(std::span<const Recipe> recipes, std::span<const Kind> kinds, bool with_press_time) {
  if (recipes.empty()) throw SetupError("no recipe: at least one type of piece is needed");
  if (recipes.size() > kMax)
    throw SetupError(std::to_string(recipes.size()) + " recipes, at most " + std::to_string(kMax) +
                     " are allowed");
  for (const Recipe& recipe : recipes) {
    if (recipe.code == 0) throw SetupError("recipe code 0 is not allowed: it means that no code was read");
    if (find(recipe.code) != nullptr)
      throw SetupError("recipe " + std::to_string(recipe.code) + " is given twice");
    PieceType& type = types_[size_++];
    type.code = recipe.code;
    for (const Kind kind : kinds) {
      const auto index = static_cast<std::size_t>(kind);
      type.variant[index] = static_cast<std::uint8_t>(recipe.value(kValueNames[index], 1, 2));
    }
    if (with_press_time) type.press_ns = recipe.value("press_time", kPressMin_ns, kPressMax_ns);
  }
}

const PieceType* PieceTypes::find(std::uint32_t code) const noexcept {
  for (std::size_t i = 0; i < size_; ++i)
    if (types_[i].code == code) return &types_[i];
  return nullptr;
}

}  // namespace stationd::programs

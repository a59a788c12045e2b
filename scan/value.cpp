#include "scan/value.hpp"

#include <array>
#include <cstddef>
#include <limits>

namespace stationd {

std::string_view name_of(TagType type) noexcept {
  static constexpr std::array<std::string_view, 13> names = {"BOOL",  "SINT", "INT",   "DINT",  "LINT",
                                                             "USINT", "UINT", "UDINT", "ULINT", "REAL",
                                                             "LREAL", "TIME", "STRING"};
  return names[static_cast<std::size_t>(type)];
}

std::string_view name_of(Quality quality) noexcept {
  static constexpr std::array<std::string_view, 4> names = {"BAD", "STALE", "GOOD", "FORCED"};
  return names[static_cast<std::size_t>(quality)];
}

std::string_view name_of(Area area) noexcept {
  static constexpr std::array<std::string_view, 4> names = {"input", "output", "internal", "retained"};
  return names[static_cast<std::size_t>(area)];
}

IntegerRange integer_range(TagType type) noexcept {
  switch (type) {
    case TagType::BOOL: return {0, 1};
    case TagType::SINT:
      return {std::numeric_limits<std::int8_t>::min(), std::numeric_limits<std::int8_t>::max()};
    case TagType::INT:
      return {std::numeric_limits<std::int16_t>::min(), std::numeric_limits<std::int16_t>::max()};
    case TagType::DINT:
      return {std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()};
    case TagType::USINT: return {0, std::numeric_limits<std::uint8_t>::max()};
    case TagType::UINT: return {0, std::numeric_limits<std::uint16_t>::max()};
    case TagType::UDINT: return {0, std::numeric_limits<std::uint32_t>::max()};
    case TagType::ULINT: return {0, std::numeric_limits<std::int64_t>::max()};
    default: return {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()};
  }
}

}  // namespace stationd

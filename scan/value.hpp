// Values of tags: IEC 61131-3 elementary types in 8-byte slots, with quality.
// Owned by whoever holds the slot; no state of its own.
// Any thread; nothing here allocates or blocks.
#pragma once

#include <bit>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace stationd {

/// One slot holds one elementary value: integers sign- or zero-extended, REAL and LREAL by their bit pattern.
using Slot = std::uint64_t;

/// IEC 61131-3 elementary types. TIME is int64 nanoseconds here. A STRING takes 1 + ceil(length / 8) slots.
enum class TagType : std::uint8_t {
  BOOL,
  SINT,
  INT,
  DINT,
  LINT,
  USINT,
  UINT,
  UDINT,
  ULINT,
  REAL,
  LREAL,
  TIME,
  STRING
};

/// Order matters: the worse of two qualities is the smaller one.
enum class Quality : std::uint8_t {
  BAD = 0,    ///< source failed, lost, or never seen
  STALE = 1,  ///< older than its limit
  GOOD = 2,
  FORCED = 3  ///< set by an operator, whatever the source says
};

/// Areas of the process image.
enum class Area : std::uint8_t { input, output, internal, retained };

/// "BOOL", "UDINT", ...
std::string_view name_of(TagType type) noexcept;
std::string_view name_of(Quality quality) noexcept;
std::string_view name_of(Area area) noexcept;

/// Least and greatest value of an integer type (or BOOL, TIME), as the signed 64-bit number it is written as;
/// ULINT's greatest is INT64_MAX here.
struct IntegerRange {
  std::int64_t min;
  std::int64_t max;
};
IntegerRange integer_range(TagType type) noexcept;

/// C++ type to slot and back. TIME has its own tag type, since int64_t is LINT.
struct Time {
  std::int64_t ns = 0;
};

template <class T> struct TagTypeOf;
template <> struct TagTypeOf<bool> { static constexpr TagType value = TagType::BOOL; };
template <> struct TagTypeOf<std::int8_t> { static constexpr TagType value = TagType::SINT; };
template <> struct TagTypeOf<std::int16_t> { static constexpr TagType value = TagType::INT; };
template <> struct TagTypeOf<std::int32_t> { static constexpr TagType value = TagType::DINT; };
template <> struct TagTypeOf<std::int64_t> { static constexpr TagType value = TagType::LINT; };
template <> struct TagTypeOf<std::uint8_t> { static constexpr TagType value = TagType::USINT; };
template <> struct TagTypeOf<std::uint16_t> { static constexpr TagType value = TagType::UINT; };
template <> struct TagTypeOf<std::uint32_t> { static constexpr TagType value = TagType::UDINT; };
template <> struct TagTypeOf<std::uint64_t> { static constexpr TagType value = TagType::ULINT; };
template <> struct TagTypeOf<float> { static constexpr TagType value = TagType::REAL; };
template <> struct TagTypeOf<double> { static constexpr TagType value = TagType::LREAL; };
template <> struct TagTypeOf<Time> { static constexpr TagType value = TagType::TIME; };

template <class T> constexpr Slot to_slot(T value) noexcept {
  if constexpr (std::is_same_v<T, float>)
    return std::bit_cast<std::uint32_t>(value);
  else if constexpr (std::is_same_v<T, double>)
    return std::bit_cast<std::uint64_t>(value);
  else if constexpr (std::is_same_v<T, Time>)
    return static_cast<Slot>(value.ns);
  else
    return static_cast<Slot>(value);
}

template <class T> constexpr T from_slot(Slot slot) noexcept {
  if constexpr (std::is_same_v<T, float>)
    return std::bit_cast<float>(static_cast<std::uint32_t>(slot));
  else if constexpr (std::is_same_v<T, double>)
    return std::bit_cast<double>(slot);
  else if constexpr (std::is_same_v<T, Time>)
    return Time{static_cast<std::int64_t>(slot)};
  else if constexpr (std::is_same_v<T, bool>)
    return slot != 0;
  else
    return static_cast<T>(slot);
}

}  // namespace stationd

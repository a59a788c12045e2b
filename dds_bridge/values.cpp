#include "dds_bridge/values.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "scan/units.hpp"

namespace stationd::bus {
namespace {

template <class T> std::optional<T> number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> time_ns(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  if (text.find(' ') != std::string_view::npos) return std::nullopt;
  const auto ns = parse_duration_ns(text);
  return negative && ns ? std::optional(-*ns) : ns;
}

bool has_range(const TagSpec& spec) { return spec.min != 0 || spec.max != 0; }

/// Whether the slot lies in the tag's range, compared as what it is.
bool in_range(const TagSpec& spec, Slot slot) {
  const auto within = [&](auto value, auto low, auto high) { return low <= value && value <= high; };
  switch (spec.type) {
    case TagType::REAL:
      return within(from_slot<float>(slot), from_slot<float>(spec.min), from_slot<float>(spec.max));
    case TagType::LREAL:
      return within(from_slot<double>(slot), from_slot<double>(spec.min), from_slot<double>(spec.max));
    case TagType::ULINT: return within(slot, spec.min, spec.max);
    default:
      return within(static_cast<std::int64_t>(slot), static_cast<std::int64_t>(spec.min),
                    static_cast<std::int64_t>(spec.max));
  }
}

std::optional<Slot> slot_of(TagType type, std::string_view text) {
  switch (type) {
    case TagType::BOOL:
      if (text == "true" || text == "1" || text == "on") return Slot{1};
      if (text == "false" || text == "0" || text == "off") return Slot{0};
      return std::nullopt;
    case TagType::REAL: {
      const auto value = number<float>(text);
      if (!value || !std::isfinite(*value)) return std::nullopt;
      return to_slot(*value);
    }
    case TagType::LREAL: {
      const auto value = number<double>(text);
      if (!value || !std::isfinite(*value)) return std::nullopt;
      return to_slot(*value);
    }
    case TagType::TIME: {
      const auto value = time_ns(text);
      return value ? std::optional(static_cast<Slot>(*value)) : std::nullopt;
    }
    case TagType::ULINT: return number<std::uint64_t>(text);
    case TagType::STRING: return std::nullopt;
    default: {
      const auto value = number<std::int64_t>(text);
      const IntegerRange range = integer_range(type);
      if (!value || *value < range.min || *value > range.max) return std::nullopt;
      return static_cast<Slot>(*value);
    }
  }
}

template <class T> std::string decimal(T value) {
  std::array<char, 64> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} ? std::string(text.data(), end) : std::string("?");
}

/// How a value of that type is written, for whoever wrote it otherwise.
std::string form_of(TagType type) {
  switch (type) {
    case TagType::BOOL: return "; say true or false, 1 or 0, on or off";
    case TagType::REAL:
    case TagType::LREAL: return "; say a number such as 0.5";
    case TagType::TIME: return "; say it with its unit, such as 800ms";
    case TagType::STRING: return ", and STRINGs cannot be written";
    default:
      return "; say a whole number, " +
             format_range({.name = {}, .type = type, .unit = {}, .description = {}});
  }
}

}  // namespace

ParsedValue parse_value(const TagSpec& spec, std::string_view text) {
  const std::string type(name_of(spec.type));
  const auto slot = slot_of(spec.type, text);
  if (!slot) return {0, std::string(text) + " is no " + type + " value" + form_of(spec.type)};
  if (has_range(spec) && !in_range(spec, *slot)) {
    return {0, std::string(text) + " is out of range " + format_range(spec)};
  }
  return {*slot, {}};
}

std::string format_value(TagType type, Slot slot) {
  switch (type) {
    case TagType::BOOL: return slot != 0 ? "true" : "false";
    case TagType::REAL: return decimal(from_slot<float>(slot));
    case TagType::LREAL: return decimal(from_slot<double>(slot));
    case TagType::TIME: return duration_text(static_cast<std::int64_t>(slot));
    case TagType::ULINT: return decimal(slot);
    case TagType::STRING: return "?";
    default: return decimal(static_cast<std::int64_t>(slot));
  }
}

std::string format_range(const TagSpec& spec) {
  if (spec.type == TagType::BOOL || spec.type == TagType::STRING) return {};
  if (has_range(spec)) return format_value(spec.type, spec.min) + ".." + format_value(spec.type, spec.max);
  if (spec.type == TagType::REAL || spec.type == TagType::LREAL || spec.type == TagType::TIME) return {};
  if (spec.type == TagType::ULINT) return "0.." + decimal(std::numeric_limits<std::uint64_t>::max());
  const IntegerRange range = integer_range(spec.type);
  return decimal(range.min) + ".." + decimal(range.max);
}

}  // namespace stationd::bus

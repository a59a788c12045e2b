#include "scan/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace stationd {
namespace {

constexpr std::array<Unit, 6> kDurations = {{{"h", 3'600'000'000'000},
                                             {"min", 60'000'000'000},
                                             {"s", 1'000'000'000},
                                             {"ms", 1'000'000},
                                             {"us", 1'000},
                                             {"ns", 1}}};

}  // namespace

std::optional<std::int64_t> parse_with_unit(std::string_view text, std::span<const Unit> units) {
  std::size_t end = 0;
  while (end < text.size() && ((text[end] >= '0' && text[end] <= '9') || text[end] == '.')) ++end;
  const std::string_view digits = text.substr(0, end);
  std::string_view name = text.substr(end);
  while (!name.empty() && name.front() == ' ') name.remove_prefix(1);
  const auto unit = std::find_if(units.begin(), units.end(), [&](const Unit& u) { return u.name == name; });
  if (digits.empty() || unit == units.end()) return std::nullopt;
  const std::size_t dot = digits.find('.');
  std::string fraction(dot == std::string_view::npos ? std::string_view{} : digits.substr(dot + 1));
  if (digits.front() == '.' || digits.back() == '.' || fraction.size() > 12) return std::nullopt;
  const std::string all = std::string(digits.substr(0, dot)) + fraction;
  std::int64_t value = 0;
  const auto [rest, error] = std::from_chars(all.data(), all.data() + all.size(), value);
  if (error != std::errc{} || rest != all.data() + all.size()) return std::nullopt;
  std::int64_t scale = 1;
  for (std::size_t i = 0; i < fraction.size(); ++i) scale *= 10;
  std::int64_t product = 0;
  if (__builtin_mul_overflow(value, unit->factor, &product) || product % scale != 0) return std::nullopt;
  return product / scale;
}

std::string with_unit(std::int64_t value, std::span<const Unit> units) {
  for (const Unit& unit : units)
    if (value != 0 && value % unit.factor == 0)
      return std::to_string(value / unit.factor) + std::string(unit.name);
  return std::to_string(value) + std::string(units.back().name);
}

std::optional<std::int64_t> parse_duration_ns(std::string_view text) {
  return parse_with_unit(text, kDurations);
}

std::string duration_text(std::int64_t ns) { return ns == 0 ? "0s" : with_unit(ns, kDurations); }

}  // namespace stationd

#include "io/plant/parse.hpp"

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>

#include "scan/units.hpp"

namespace stationd::plant {

namespace {

[[noreturn]] void refuse(std::string_view what, std::string_view found, const std::string& allowed) {
  throw std::invalid_argument(std::string(what) + ": \"" + std::string(found) + "\" is not " + allowed);
}

}  // namespace

std::int64_t parse_integer(std::string_view text, std::string_view what, std::int64_t min, std::int64_t max) {
  std::int64_t value = 0;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  if (error != std::errc{} || end != last || value < min || value > max) {
    refuse(what, text, "an integer from " + std::to_string(min) + " to " + std::to_string(max));
  }
  return value;
}

std::int64_t parse_duration_ns(std::string_view text, std::string_view what) {
  constexpr std::int64_t kMost = 100'000'000'000'000'000;  // three years
  const auto ns = stationd::parse_duration_ns(text);
  if (!ns || *ns > kMost) refuse(what, text, "a duration such as 500ms or 2s (ns, us, ms, s, min, h)");
  return *ns;
}

double parse_positive(std::string_view text, std::string_view what, double max) {
  double value = 0;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  if (error != std::errc{} || end != last || !std::isfinite(value) || value <= 0 || value > max) {
    refuse(what, text, "a number above 0, at most " + std::to_string(static_cast<std::int64_t>(max)));
  }
  return value;
}

}  // namespace stationd::plant

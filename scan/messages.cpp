#include "scan/messages.hpp"

#include <array>
#include <cstddef>

namespace stationd {

std::string_view name_of(StationState state) noexcept {
  static constexpr std::array<std::string_view, 4> names = {"STOPPED", "RUNNING", "STOPPING", "FAULT"};
  return names[static_cast<std::size_t>(state)];
}

std::string_view name_of(Severity severity) noexcept {
  static constexpr std::array<std::string_view, 3> names = {"info", "warning", "fault"};
  return names[static_cast<std::size_t>(severity)];
}

}  // namespace stationd

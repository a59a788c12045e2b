#include "scan/figures.hpp"

#include <algorithm>
#include <array>

namespace stationd {
namespace {

constexpr std::array<std::string_view, kFigures> kNames = {
    "lateness", "execution", "response", "task_execution", "task_response",
    "latch",    "execute",   "commit",   "publish",        "service"};

}  // namespace

std::string_view name_of(Figure figure) noexcept { return kNames[static_cast<std::size_t>(figure)]; }

std::optional<Figure> find_figure(std::string_view name) noexcept {
  const auto* const found = std::ranges::find(kNames, name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<Figure>(found - kNames.begin());
}

std::string_view name_of(Window window) noexcept {
  return window == Window::since_start ? "since_start" : "last_minute";
}

}  // namespace stationd

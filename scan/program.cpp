#include "scan/program.hpp"

#include "scan/error.hpp"

namespace stationd {

Handle::Handle(Program& owner, TagSpec spec) : spec_(std::move(spec)) { owner.handles_.push_back(this); }

std::int64_t Recipe::value(std::string_view wanted, std::int64_t min, std::int64_t max) const {
  const std::string where = "recipe " + std::to_string(code) + ": ";
  for (const auto& [key, number] : values) {
    if (key != wanted) continue;
    if (number < min || number > max)
      throw SetupError(where + key + " is " + std::to_string(number) + ", allowed are " +
                       std::to_string(min) + " to " + std::to_string(max));
    return number;
  }
  throw SetupError(where + std::string(wanted) + " is missing");
}

}  // namespace stationd

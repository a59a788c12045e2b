// Configuration fixture: a small good file to break, and a program for it.
// Owned by the configuration tests.
// One thread.
#pragma once

#include <string>
#include <string_view>

#include "config/config.hpp"

namespace stationd::config {

inline constexpr std::string_view kGoodController = R"(# a controller with one press
[controller]
name = "c1"
[[task]]
name = "fast"
period = "10ms"
[[device]]
name = "io-1"
address = "127.0.0.1:5020"
[[station]]
name = "press"
program = "presser"
[station.inputs]
part_present = "io-1:di:0"
force = { at = "io-1:ir:4", type = "UDINT", max_age = "100ms" }
[station.outputs]
press_down = "io-1:co:0"
pressure = { at = "io-1:hr:10", safe = 5 }
[station.parameters]
press_time = "800ms"
limit = 2.5
)";

/// The good file with `from` replaced by `to`; `from` must be there.
inline std::string with(std::string_view from, std::string_view to, std::string_view text = kGoodController) {
  std::string out(text);
  return out.replace(out.find(from), from.size(), to);
}

inline std::string all_of(const std::vector<Problem>& problems) {
  std::string out;
  for (const Problem& problem : problems) out += problem.text + "\n";
  return out;
}

inline ProgramCatalogue presser_catalogue() {
  ProgramCatalogue catalogue;
  catalogue.names = {"presser", "feeder"};
  catalogue.tags = [](const std::string&, const ProgramOptions&) {
    ProgramTags tags;
    tags.tags.push_back(tag_spec<bool>("part_present", Area::input, "a part lies in the press"));
    tags.tags.push_back(tag_spec<std::uint32_t>("force", Area::input, "at the ram"));
    tags.tags.push_back(tag_spec<std::uint32_t>("ready.code", Area::input, "from the bus"));
    tags.tags.push_back(tag_spec<bool>("press_down", Area::output, "ram"));
    tags.tags.back().hold = true;
    tags.tags.push_back(tag_spec<std::uint16_t>("pressure", Area::output, "set point"));
    tags.tags.push_back(tag_spec<Time>("press_time", Area::internal, "how long"));
    tags.tags.back().parameter = true;
    tags.tags.back().min = to_slot(Time{100'000'000});
    tags.tags.back().max = to_slot(Time{5'000'000'000});
    tags.tags.push_back(tag_spec<float>("limit", Area::internal, "of force"));
    tags.tags.back().parameter = true;
    tags.tags.push_back(tag_spec<std::uint32_t>("pieces", Area::retained, "pressed so far"));
    tags.tags.push_back(tag_spec<bool>("dry_run", Area::internal, "without parts"));
    tags.bus_inputs = {"ready.code"};
    return tags;
  };
  return catalogue;
}

}  // namespace stationd::config

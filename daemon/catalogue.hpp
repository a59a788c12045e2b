// Catalogue: tells the configuration which programs there are and what tags they declare.
// Owned by main(); a plain value.
// Set-up only.
#pragma once

#include "config/config.hpp"
#include "programs/programs.hpp"

namespace stationd {

config::ProgramCatalogue program_catalogue(const ProgramList& programs = all_programs());

}  // namespace stationd

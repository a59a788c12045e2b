// What plantsim's command line says.
// Owned by plantsim's main.
// Set-up only.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/plant/types.hpp"

namespace stationd::plant {

struct PlantsimOptions {
  bool help = false;
  bool quiet = false;
  std::string bind = "127.0.0.1";
  std::uint16_t port = 5020;
  double speed = 1.0;
  std::int64_t watchdog_ns = 500'000'000;  ///< real time; 0: none
  std::uint32_t pieces_exit = 0;           ///< end when so many pieces are stored; 0: never
  std::string ledger_file, state_file, ready_file;
  std::vector<Fault> faults;  ///< from_ns counts from the start of this run
  PlantConfig plant;
};

/// The text of --help.
const char* plantsim_help() noexcept;

/// Reads the arguments behind the program's name. Throws std::invalid_argument that names the option, what
/// was found and what is allowed.
PlantsimOptions parse_plantsim_options(std::span<const char* const> arguments);

}  // namespace stationd::plant

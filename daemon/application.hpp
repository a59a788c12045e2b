// The program `stationd`: command line, signals, service notification, exit statuses around one Controller.
// Owned by main().
// The main thread.
#pragma once

#include <string>
#include <vector>

#include "programs/programs.hpp"

namespace stationd {

/// Runs what the command line asks for, with stations that run one of `programs`; the result is the process's
/// exit status (exit_status.hpp).
int run_stationd(const std::vector<std::string>& arguments, const ProgramList& programs = all_programs());

}  // namespace stationd

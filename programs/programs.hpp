// Programs: the list of all programs that a station can run, by name.
// Owned by nobody.
// Set-up only.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "scan/program.hpp"

namespace stationd::programs {

/// The program of that kind ("loader", "robot", ...). Throws SetupError: an unknown kind (names the known
/// ones) or options that the program cannot work with.
std::unique_ptr<Program> make_program(const std::string& kind, const ProgramOptions& options);
std::vector<std::string> program_names();

// One maker per program file; programs.cpp lists them.
std::unique_ptr<Program> make_loader(const ProgramOptions& options);
std::unique_ptr<Program> make_robot(const ProgramOptions& options);
std::unique_ptr<Program> make_sealer(const ProgramOptions& options);
std::unique_ptr<Program> make_storage(const ProgramOptions& options);
std::unique_ptr<Program> make_example(const ProgramOptions& options);

}  // namespace stationd::programs

namespace stationd {
using programs::make_program;
using programs::program_names;
}  // namespace stationd

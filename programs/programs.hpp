// Programs: the list of all programs that a station can run, by name.
// Owned by nobody.
// Set-up only.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "scan/program.hpp"

namespace stationd::programs {

struct ProgramEntry {
  std::string name;
  std::unique_ptr<Program> (*make)(const ProgramOptions&);
};
using ProgramList = std::vector<ProgramEntry>;

/// All that stationd is built with. A daemon with more of them is a main() of two lines: see
/// docs/programs.md.
ProgramList all_programs();

/// The program of that kind ("loader", "robot", ...). Throws SetupError: an unknown kind (names the known
/// ones) or options that the program cannot work with.
std::unique_ptr<Program> make_program(const std::string& kind, const ProgramOptions& options,
                                      const ProgramList& list = all_programs());
std::vector<std::string> program_names(const ProgramList& list = all_programs());

// One maker per program file; programs.cpp lists them.
std::unique_ptr<Program> make_loader(const ProgramOptions& options);
std::unique_ptr<Program> make_robot(const ProgramOptions& options);
std::unique_ptr<Program> make_sealer(const ProgramOptions& options);
std::unique_ptr<Program> make_storage(const ProgramOptions& options);
std::unique_ptr<Program> make_example(const ProgramOptions& options);

}  // namespace stationd::programs

namespace stationd {
using programs::all_programs;
using programs::make_program;
using programs::program_names;
using programs::ProgramList;
}  // namespace stationd

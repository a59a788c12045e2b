#include "programs/programs.hpp"

#include "scan/error.hpp"

namespace stationd::programs {

// A new program: one line here, one declaration in programs.hpp, one file.
ProgramList all_programs() {
  return {
      {"loader", make_loader},   {"robot", make_robot},     {"sealer", make_sealer},
      {"storage", make_storage}, {"example", make_example},
  };
}

std::vector<std::string> program_names(const ProgramList& list) {
  std::vector<std::string> names;
  for (const ProgramEntry& entry : list) names.push_back(entry.name);
  return names;
}

std::unique_ptr<Program> make_program(const std::string& kind, const ProgramOptions& options,
                                      const ProgramList& list) {
  std::string known;
  for (const ProgramEntry& entry : list) {
    if (kind == entry.name) return entry.make(options);
    known += (known.empty() ? "" : ", ") + entry.name;
  }
  throw SetupError("station " + options.station + ": no program \"" + kind + "\"; known are " + known);
}

}  // namespace stationd::programs

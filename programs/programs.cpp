#include "programs/programs.hpp"

#include <array>

#include "scan/error.hpp"

namespace stationd::programs {
namespace {

struct Entry {
  const char* name;
  std::unique_ptr<Program> (*make)(const ProgramOptions&);
};

// A new program: one line here, one declaration in programs.hpp, one file.
constexpr auto kPrograms = std::to_array<Entry>({
    {"loader", make_loader},
    {"robot", make_robot},
    {"sealer", make_sealer},
    {"storage", make_storage},
    {"example", make_example},
});

}  // namespace

std::vector<std::string> program_names() {
  std::vector<std::string> names;
  for (const Entry& entry : kPrograms) names.emplace_back(entry.name);
  return names;
}

std::unique_ptr<Program> make_program(const std::string& kind, const ProgramOptions& options) {
  std::string known;
  for (const Entry& entry : kPrograms) {
    if (kind == entry.name) return entry.make(options);
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw SetupError("station " + options.station + ": no program \"" + kind + "\"; known are " + known);
}

}  // namespace stationd::programs

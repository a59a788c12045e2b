#include "daemon/catalogue.hpp"

namespace stationd {

config::ProgramCatalogue program_catalogue(const ProgramList& programs) {
  config::ProgramCatalogue catalogue;
  catalogue.names = program_names(programs);
  catalogue.tags = [programs](const std::string& kind, const ProgramOptions& options) {
    const std::unique_ptr<Program> program = make_program(kind, options, programs);
    config::ProgramTags result;
    for (const Handle* handle : program->handles()) result.tags.push_back(handle->spec());
    for (const PvSubscription& s : program->subscriptions())
      for (const PvMember& m : s.members) result.bus_inputs.push_back(m.handle->spec().name);
    return result;
  };
  return catalogue;
}

}  // namespace stationd

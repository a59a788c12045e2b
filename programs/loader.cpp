// Loader: reads the pallet's code and puts the base on it. First station: its pallets come from the cell's
// infeed.
#include "programs/assembler.hpp"
#include "programs/programs.hpp"

namespace stationd::programs {
namespace {

constexpr std::array kKindsHandled = {Kind::base};

class Loader final : public Assembler {
 public:
  explicit Loader(const ProgramOptions& options)
      : Assembler(options, {kKindsHandled, false}, {{Kind::base, "base", kArmFirstFeeder}}, false) {}
};

}  // namespace

std::unique_ptr<Program> make_loader(const ProgramOptions& options) {
  return std::make_unique<Loader>(options);
}

}  // namespace stationd::programs

// Sealer: puts the lid on and presses it. Fetches the lid of the announced piece before its pallet comes.
#include "programs/assembler.hpp"
#include "programs/programs.hpp"

namespace stationd::programs {
namespace {

constexpr std::array kKindsHandled = {Kind::lid};

class Sealer final : public Assembler {
 public:
  explicit Sealer(const ProgramOptions& options)
      : Assembler(options, {kKindsHandled, true}, {{Kind::lid, "lid", kArmFirstFeeder}}, true) {}
};

}  // namespace

std::unique_ptr<Program> make_sealer(const ProgramOptions& options) {
  return std::make_unique<Sealer>(options);
}

}  // namespace stationd::programs

// Robot: fits the bearing, then the shaft. Fetches the bearing of the announced piece before its pallet
// comes.
#include "programs/assembler.hpp"
#include "programs/programs.hpp"

namespace stationd::programs {
namespace {

constexpr std::array kKindsHandled = {Kind::bearing, Kind::shaft};

class Robot final : public Assembler {
 public:
  explicit Robot(const ProgramOptions& options)
      : Assembler(options, {kKindsHandled, false},
                  {{Kind::bearing, "bearing", kArmFirstFeeder}, {Kind::shaft, "shaft", kArmFirstFeeder + 2}},
                  true) {}
};

}  // namespace

std::unique_ptr<Program> make_robot(const ProgramOptions& options) {
  return std::make_unique<Robot>(options);
}

}  // namespace stationd::programs

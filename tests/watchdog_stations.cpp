// stationd with two more programs, for tests of the watchdog: `looper` drives an output and then does not
// return from its scan, `steady` counts its scans.
#include <string>
#include <vector>

#include "daemon/application.hpp"
#include "scan/cycle.hpp"

namespace stationd {
namespace {

class Looper final : public Program {
 public:
  explicit Looper(const ProgramOptions&) {}
  void execute(Cycle& cycle) noexcept override {
    lamp_ = true;
    if (at_scan_ == 0 || cycle.scan() < at_scan_) return;
    for (std::uint32_t i = 0; rounds_.get() == 0 || i < rounds_.get(); ++i)
      for (volatile int spin = 0; spin < 1'000'000;) spin = spin + 1;
  }

 private:
  Out<bool> lamp_{*this, "lamp", "on while the program runs"};
  Param<std::uint32_t> at_scan_{*this, "at_scan", "it hangs from that scan on; 0: never",
                                0,     0,         4'000'000'000};
  Param<std::uint32_t> rounds_{*this, "rounds", "millions of turns; 0: for ever", 0, 0, 4'000'000'000};
};

class Steady final : public Program {
 public:
  explicit Steady(const ProgramOptions&) {}
  void execute(Cycle& cycle) noexcept override {
    lamp_ = true;
    cycle.report(1, 0, true);
  }

 private:
  Out<bool> lamp_{*this, "lamp", "on while the program runs"};
};

std::unique_ptr<Program> make_looper(const ProgramOptions& options) {
  return std::make_unique<Looper>(options);
}
std::unique_ptr<Program> make_steady(const ProgramOptions& options) {
  return std::make_unique<Steady>(options);
}

}  // namespace
}  // namespace stationd

int main(int argc, char** argv) {
  stationd::ProgramList programs = stationd::all_programs();
  programs.push_back({"looper", stationd::make_looper});
  programs.push_back({"steady", stationd::make_steady});
  return stationd::run_stationd(std::vector<std::string>(argv + 1, argv + argc), programs);
}

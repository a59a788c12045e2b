// Example: a pump that fills a tank between two level switches. Copy this file to write a program of your
// own: docs/programs.md says what each part is for.
#include "programs/programs.hpp"
#include "scan/codes.hpp"
#include "scan/cycle.hpp"

namespace stationd::programs {
namespace {

enum Step : std::uint32_t { full = 1, filling = 2 };

class Example final : public Program {
 public:
  // Set-up: declare the tags. It may allocate and throw SetupError; options has the neighbours and recipes.
  explicit Example(const ProgramOptions&)
      : level_low_(*this, "level_low", "the tank is below its lower mark"),
        level_high_(*this, "level_high", "the tank is above its upper mark"),
        pump_(*this, "pump", "fills the tank; de-energised: off"),
        fill_timeout_(*this, "fill_timeout", "longest time that filling may take", Time{60'000'000'000},
                      Time{1'000'000'000}, Time{3'600'000'000'000}),
        fillings_(*this, "fillings", "times that the tank was filled") {}

  // One scan while the station runs: no allocation, no lock, no clock, no log. Outputs are safe outside
  // RUNNING.
  void execute(Cycle& cycle) noexcept override {
    if (!level_low_.good() || !level_high_.good()) return cycle.fault(code::example_inputs_lost);
    if (cycle.started()) enter(level_high_ ? full : filling, cycle);
    if (step_ == full && level_low_) enter(filling, cycle);
    if (step_ == filling && level_high_) {
      fillings_ = fillings_ + 1;
      enter(full, cycle);
      cycle.finished();  // a Stop with mode=end_of_piece takes effect here
    }
    if (step_ == filling && cycle.now_ns() - entered_ns_ > fill_timeout_.get().ns)
      cycle.fault(code::example_fill_timeout);
    pump_ = step_ == filling;
    cycle.report(step_, 0, true);
  }

  std::string_view step_name(std::uint32_t step) const noexcept override {
    return step == full ? "full" : step == filling ? "filling" : "";
  }

 private:
  void enter(Step step, const Cycle& cycle) noexcept {
    step_ = step;
    entered_ns_ = cycle.now_ns();
  }

  In<bool> level_low_, level_high_;
  Out<bool> pump_;
  Param<Time> fill_timeout_;
  Retained<std::uint32_t> fillings_;
  Step step_ = full;
  std::int64_t entered_ns_ = 0;
};

}  // namespace

std::unique_ptr<Program> make_example(const ProgramOptions& options) {
  return std::make_unique<Example>(options);
}

}  // namespace stationd::programs

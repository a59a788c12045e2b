// A station whose program allocates in its scan (SCAN-5). It must not compile under -Wfunction-effects
// (STATIOND_PROVE), and where that is switched off, RealtimeSanitizer must end it in its first scan.
#include <memory>

#include "scan/cycle.hpp"
#include "scan/station.hpp"

#ifndef STATIOND_PROVE
#pragma clang diagnostic ignored "-Wfunction-effects"
#endif

namespace stationd {
namespace {

class Allocates final : public Program {
 public:
  void execute(Cycle&) noexcept override {}
  void idle(Cycle&) noexcept override { kept_.reset(new std::int64_t[1024]); }

 private:
  std::unique_ptr<std::int64_t[]> kept_;
};

}  // namespace
}  // namespace stationd

int main() {
  stationd::StationOptions options;
  options.name = "allocates";
  stationd::Station station(options, std::make_unique<stationd::Allocates>());
  station.seal();
  station.begin(1'000'000, 1, 0);
  station.latch();
  station.execute();
  return 0;
}

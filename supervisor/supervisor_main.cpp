// stationd-supervisor FILE: the paper's fifth component. Starts the stations, watches them, counts pieces.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "dds_bridge/text.hpp"
#include "scan/error.hpp"
#include "supervisor/application.hpp"
#include "supervisor/arguments.hpp"
#include "supervisor/screen.hpp"

namespace {

using namespace stationd;

enum : int { kOk = 0, kUsageError = 64, kUnavailable = 69, kCannotCreate = 73, kConfigError = 78 };

std::atomic<bool> stop_wanted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void on_signal(int) { stop_wanted.store(true); }

void handle_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(signal, &action, nullptr);
  action.sa_handler = SIG_IGN;  // whoever reads our lines may go; the cell goes on
  ::sigaction(SIGPIPE, &action, nullptr);
}

int fail(int status, const std::string& text) {
  std::fprintf(stderr, "stationd-supervisor: %s\n", text.c_str());
  return status;
}

std::unique_ptr<supervisor::StateStore> make_store(const config::SupervisorConfiguration& configuration,
                                                   bool observe) {
  if (observe) return std::make_unique<supervisor::NullStateStore>();
  return std::make_unique<supervisor::FileStateStore>(configuration.journal_file);
}

int supervise(const config::SupervisorConfiguration& configuration, const supervisor::Arguments& arguments) {
  const auto store = make_store(configuration, arguments.observe);
  const std::string title =
      "cell " + configuration.bus.cell + ", domain " + std::to_string(configuration.bus.domain);
  const auto screen = supervisor::make_screen(arguments.live, title);
  supervisor::Application application(configuration, arguments, *store, *screen);
  handle_signals();
  application.run(stop_wanted);
  std::printf("%s", application.summary().c_str());
  return kOk;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string_view> words(argv + (argc > 0 ? 1 : 0), argv + argc);
  const supervisor::Arguments arguments = supervisor::parse_arguments(words);
  if (!arguments.problem.empty()) return fail(kUsageError, arguments.problem + "; see --help");
  if (arguments.help) return std::printf("%s", supervisor::kUsage.data()) < 0 ? 1 : kOk;
  if (arguments.version) {
    std::printf("stationd-supervisor %s (%s)\n", STATIOND_VERSION, bus::dds_version().c_str());
    return kOk;
  }
  const auto loaded = config::load_supervisor(arguments.file);
  if (!loaded) {
    for (const config::Problem& problem : loaded.problems) std::fprintf(stderr, "%s\n", problem.text.c_str());
    return fail(kConfigError, bus::count_text(loaded.problems.size(), "error") + " in " + arguments.file);
  }
  if (arguments.check) {
    const config::SupervisorConfiguration& good = *loaded.value;
    std::printf("%s: good: supervisor %s, %s\n", arguments.file.c_str(), good.name.c_str(),
                bus::count_text(good.stations.size(), "station").c_str());
    return kOk;
  }
  try {
    return supervise(*loaded.value, arguments);
  } catch (const bus::BusError& error) {
    return fail(kUnavailable, error.what());
  } catch (const supervisor::StateTaken& error) {
    return fail(kUnavailable, error.what());
  } catch (const SetupError& error) {
    return fail(kCannotCreate, error.what());
  }
}

// plantsim: the simulated cell as a Modbus/TCP device of four units.
#include <sysexits.h>
#include <time.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>

#include "io/plant/live_plant.hpp"
#include "io/plant/modbus_server.hpp"
#include "io/plant/plantsim_options.hpp"
#include "scan/clock.hpp"

namespace {

using namespace stationd::plant;

constexpr int kPollMs =
    10;  // requests bring the plant up to date themselves, so this bounds only the files' age

volatile std::sig_atomic_t stop_requested = 0;

void request_stop(int) { stop_requested = 1; }

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGINT, &action, nullptr);
  action.sa_handler = SIG_IGN;
  ::sigaction(SIGPIPE, &action, nullptr);
}

int complain(const std::string& what, int status) {
  std::fprintf(stderr, "plantsim: %s\n", what.c_str());
  return status;
}

void announce(const PlantsimOptions& options, std::uint16_t port) {
  const std::string where = options.bind + ":" + std::to_string(port);
  if (!options.quiet) std::printf("plantsim: listening on %s\n", where.c_str());
  std::fflush(stdout);
  if (!options.ready_file.empty()) write_atomically(options.ready_file, where + "\n");
}

void inject_all(Plant& plant, const PlantsimOptions& options) {
  for (Fault fault : options.faults) {
    fault.from_ns += plant.now_ns();
    plant.inject(fault);
  }
}

/// Until a signal or the last piece. A file that cannot be written is said once and tried again: the plant
/// goes on.
void serve(LivePlant& live, ModbusServer& server, const PlantsimOptions& options) {
  bool complained = false;
  while (stop_requested == 0) {
    server.poll(live.plant(), kPollMs, [&] { live.advance(stationd::monotonic_ns()); });
    const LivePlant::Due due = live.due(stationd::monotonic_ns());
    try {
      live.write(due);
    } catch (const std::system_error& error) {
      if (!complained) complain(error.what(), 0);
      complained = true;
    }
    if (options.pieces_exit != 0 && live.plant().ledger().verdict().stored >= options.pieces_exit) return;
  }
}

void summarise(const Plant& plant, const PlantsimOptions& options) {
  if (options.quiet) return;
  const Verdict v = plant.ledger().verdict();
  std::printf("plantsim: %u pallets, %u stored, %u right, %u wrong, %u violations, %s\n", v.pallets, v.stored,
              v.stored_right, v.stored_wrong, v.violations, v.clean() ? "clean" : "NOT clean");
}

struct CannotListen : std::runtime_error {
  using std::runtime_error::runtime_error;
};

std::unique_ptr<ModbusServer> listen(const PlantsimOptions& options) {
  try {
    return std::make_unique<ModbusServer>(options.bind, options.port);
  } catch (const std::system_error& error) {
    throw CannotListen("cannot listen on " + options.bind + ":" + std::to_string(options.port) + ": " +
                       error.code().message());
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("--bind: ") + error.what());
  }
}

void run(const PlantsimOptions& options) {
  LivePlant live(options.plant, {options.speed, options.ledger_file, options.state_file});
  inject_all(live.plant(), options);
  const std::unique_ptr<ModbusServer> server = listen(options);
  catch_signals();
  announce(options, server->port());
  serve(live, *server, options);
  live.finish();
  summarise(live.plant(), options);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const PlantsimOptions options = parse_plantsim_options({argv + 1, static_cast<std::size_t>(argc - 1)});
    if (options.help) {
      std::fputs(plantsim_help(), stdout);
    } else {
      run(options);
    }
    return EX_OK;
  } catch (const std::invalid_argument& error) {
    return complain(error.what(), EX_USAGE);
  } catch (const CannotListen& error) {
    return complain(error.what(), EX_UNAVAILABLE);
  } catch (const std::system_error& error) {
    return complain(error.what(), EX_CANTCREAT);
  } catch (const std::runtime_error& error) {
    return complain(error.what(), EX_DATAERR);
  } catch (const std::exception& error) {
    return complain(error.what(), EX_SOFTWARE);
  }
}

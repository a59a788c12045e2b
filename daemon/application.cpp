#include "daemon/application.hpp"

#include <malloc.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <memory>

#include "config/config.hpp"
#include "daemon/catalogue.hpp"
#include "daemon/controller.hpp"
#include "daemon/exit_status.hpp"
#include "daemon/notify.hpp"
#include "daemon/write_safe.hpp"
#include "dds_bridge/text.hpp"
#include "scan/clock.hpp"
#include "scan/error.hpp"

namespace stationd {
namespace {

constexpr const char* kUsage =
    "usage: stationd FILE               run the controller that FILE describes\n"
    "       stationd --check FILE       check FILE, say every error in it\n"
    "       stationd --write-safe FILE  write the safe value of every output to its device, and end\n"
    "       stationd --version | --help\n"
    "exit status: 0 ended in order, 1 failed while running, 64 command line, 69 no bus or already running,\n"
    "             71 no thread or device to be had, 73 state directory not writable,\n"
    "             77 real-time rights required but refused, 78 configuration\n";

constexpr std::int64_t kHousekeepNs = 100'000'000;
constexpr std::int64_t kStatusEveryNs = 1'000'000'000;
constexpr std::int64_t kFirstScanLimitNs = 10'000'000'000;
constexpr std::size_t kThreadStackBytes =
    256 * 1024;  // memory is locked: default stacks of 8 MB would all be resident

struct Command {
  enum class What { run, check, write_safe } what = What::run;
  std::string file;
};

sigset_t signals_of_interest() {
  sigset_t set;
  sigemptyset(&set);
  for (const int s : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&set, s);
  return set;
}

/// Before any thread starts: small stacks, few arenas, signals to the main thread alone.
void prepare_process() {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kThreadStackBytes);
  pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
  mallopt(M_ARENA_MAX, 2);
  const sigset_t set = signals_of_interest();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes is a failed write like a full disk, not the end
}

LogSeverity severity_of(config::LogLevel level) { return static_cast<LogSeverity>(level); }

/// The next signal of interest, or 0 after `timeout_ns`.
int next_signal(std::int64_t timeout_ns) {
  const sigset_t set = signals_of_interest();
  const timespec timeout{timeout_ns / 1'000'000'000, timeout_ns % 1'000'000'000};
  const int s = sigtimedwait(&set, nullptr, &timeout);
  return s > 0 ? s : 0;
}

void reload(const config::Configuration& running, const ProgramList& programs, Log& log, Notify& notify) {
  notify.reloading();
  const config::ProgramCatalogue catalogue = program_catalogue(programs);
  const auto fresh = config::load_controller(running.file, &catalogue);
  if (fresh) {
    log.set_least(severity_of(fresh.value->log_level));
    log.info("configuration read again: log level applied; all else takes effect at the next restart");
  } else {
    for (const config::Problem& p : fresh.problems) log.error(p.text);
    log.error("configuration not applied: correct the errors above and reload again");
  }
  notify.ready("configuration read again");
}

/// Until every task has run its first scan and no other daemon was heard with one of our stations' names.
enum class Began : std::uint8_t { yes, interrupted, late };
Began wait_for_first_scans(Controller& controller) {
  const std::int64_t began_ns = monotonic_ns();
  const std::int64_t until_ns = began_ns + kFirstScanLimitNs + controller.longest_wait_ns();
  while (!controller.first_scans_done() || monotonic_ns() - began_ns < Controller::kListenNs) {
    controller.refuse_duplicate();
    if (monotonic_ns() > until_ns) return Began::late;
    const int s = next_signal(1'000'000);
    if (s == SIGTERM || s == SIGINT) return Began::interrupted;
  }
  controller.refuse_duplicate();
  return Began::yes;
}

/// Until SIGTERM, SIGINT, or a reason to give up.
int serve(Controller& controller, const config::Configuration& configuration, const ProgramList& programs,
          Log& log, Notify& notify) {
  std::int64_t next_status_ns = 0;
  std::int64_t next_watchdog_ns = 0;
  while (true) {
    const int s = next_signal(kHousekeepNs);
    if (s == SIGTERM || s == SIGINT) {
      log.info(std::string(s == SIGTERM ? "SIGTERM" : "SIGINT") + ": stopping, outputs go safe");
      return kExitOk;
    }
    if (s == SIGHUP) reload(configuration, programs, log, notify);
    const std::int64_t now_ns = monotonic_ns();
    controller.housekeep(now_ns);
    controller.refuse_duplicate();
    if (now_ns >= next_status_ns) {
      notify.status(controller.status_line());
      next_status_ns = now_ns + kStatusEveryNs;
    }
    if (controller.alive(now_ns) && notify.watchdog_limit_ns() > 0 && now_ns >= next_watchdog_ns) {
      notify.watchdog();
      next_watchdog_ns = now_ns + notify.watchdog_limit_ns() / 4;
    }
  }
}

/// `stopping_ns`: when the end began, of a controller that ran.
int run_controller(const config::Configuration& configuration, const ProgramList& programs, Log& log,
                   Notify& notify, std::int64_t& stopping_ns) {
  Controller controller(configuration, log, programs);
  const std::vector<RtGrant> grants = controller.start_scans();
  for (const RtGrant& grant : grants)
    if (!grant.granted && configuration.require_realtime) {
      log.error("require_realtime is set and " + grant.what + " was refused: " + grant.reason);
      return kExitNoPermission;
    }
  const Began began = wait_for_first_scans(controller);
  if (began == Began::late) log.error("no first scan in time");
  if (began != Began::yes) return began == Began::late ? kExitFailure : kExitOk;
  controller.start_field();
  log.info("ready: " + controller.status_line());
  notify.ready(controller.status_line());
  const int status = serve(controller, configuration, programs, log, notify);
  stopping_ns = monotonic_ns();
  notify.stopping();
  if (!controller.stop()) {
    // Nothing that the stuck thread uses may be freed under it; the devices have their safe values.
    log.error("a scan thread does not end: its program loops; giving it up");
    log.flush();
    _exit(kExitFailure);
  }
  log.info("ended: " + controller.status_line());
  return status;
}

int run(const config::Configuration& configuration, const ProgramList& programs) {
  prepare_process();
  Log log(configuration.name, severity_of(configuration.log_level));
  SystemdNotify notify;
  try {
    std::int64_t stopping_ns = 0;
    const int status = run_controller(configuration, programs, log, notify, stopping_ns);
    if (stopping_ns != 0)
      log.info("all ended within " + std::to_string((monotonic_ns() - stopping_ns) / 1'000'000) + " ms");
    return status;
  } catch (const AlreadyRunning& e) {
    log.error(e.what());
    return kExitUnavailable;
  } catch (const bus::BusError& e) {
    log.error(e.what());
    return kExitUnavailable;
  } catch (const StateDirectoryError& e) {
    log.error(e.what());
    return kExitCannotCreate;
  } catch (const std::exception& e) {
    log.error(std::string("cannot start: ") + e.what());
    return kExitOsError;
  }
}

bool parse(const std::vector<std::string>& arguments, Command& command, std::string& error) {
  for (const std::string& a : arguments) {
    if (a == "--check" || a == "--write-safe") {
      if (command.what != Command::What::run) error = "--check and --write-safe are one at a time";
      command.what = a == "--check" ? Command::What::check : Command::What::write_safe;
    } else if (a.size() > 1 && a.front() == '-')
      error = "unknown option \"" + a + "\"";
    else if (!command.file.empty())
      error = "more than one FILE: \"" + command.file + "\" and \"" + a + "\"";
    else
      command.file = a;
  }
  if (error.empty() && command.file.empty()) error = "no FILE given";
  return error.empty();
}

}  // namespace

int run_stationd(const std::vector<std::string>& arguments, const ProgramList& programs) {
  for (const std::string& a : arguments) {
    if (a == "--help" || a == "-h") return std::fputs(kUsage, stdout) < 0 ? kExitFailure : kExitOk;
    if (a == "--version")
      return std::printf("stationd %s, %s\n", STATIOND_VERSION, bus::dds_version().c_str()) < 0 ? kExitFailure
                                                                                                : kExitOk;
  }
  Command command;
  std::string error;
  if (!parse(arguments, command, error)) {
    std::fprintf(stderr, "stationd: %s\n%s", error.c_str(), kUsage);
    return kExitUsage;
  }
  const config::ProgramCatalogue catalogue = program_catalogue(programs);
  const auto loaded = config::load_controller(command.file, &catalogue);
  if (!loaded) {
    for (const config::Problem& p : loaded.problems) std::fprintf(stderr, "%s\n", p.text.c_str());
    std::fprintf(stderr, "stationd: %s in %s\n", bus::count_text(loaded.problems.size(), "error").c_str(),
                 command.file.c_str());
    return kExitConfig;
  }
  switch (command.what) {
    case Command::What::check:
      std::printf("%s: good: controller %s, %s, %s\n", command.file.c_str(), loaded.value->name.c_str(),
                  bus::count_text(loaded.value->stations.size(), "station").c_str(),
                  bus::count_text(loaded.value->devices.size(), "device").c_str());
      return kExitOk;
    case Command::What::write_safe: return write_safe_outputs(*loaded.value);
    case Command::What::run: break;
  }
  return run(*loaded.value, programs);
}

}  // namespace stationd

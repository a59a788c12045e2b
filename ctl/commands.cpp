#include "ctl/commands.hpp"

#include <charconv>
#include <cstdio>
#include <string>

#include "ctl/client.hpp"
#include "ctl/output.hpp"
#include "ctl/supervisor.hpp"
#include "dds_bridge/text.hpp"
#include "scan/clock.hpp"
#include "scan/codes.hpp"

namespace stationd::ctl {
namespace {

using bus::code_id;
using bus::code_text;

int carry_out(const Arguments& arguments) {
  switch (arguments.command) {
    case Command::help: std::printf("%s", kUsage.data()); return kDone;
    case Command::version:
      std::printf("stationctl %s (%s)\n", STATIOND_VERSION, bus::dds_version().c_str());
      return kDone;
    case Command::list: return list(arguments);
    case Command::watch: return watch(arguments);
    case Command::start: return start(arguments);
    case Command::stop: return stop(arguments);
    case Command::msg: return msg(arguments);
    case Command::reset: return reset(arguments);
    case Command::get: return get(arguments);
    case Command::force: return force(arguments);
    case Command::unforce: return unforce(arguments);
    case Command::set: return set(arguments);
    case Command::describe: return describe(arguments);
    case Command::events: return events(arguments);
    case Command::stats: return stats(arguments);
  }
  return kUsageError;
}

}  // namespace

int run(const Arguments& arguments) {
  if (!arguments.problem.empty())
    return fail(arguments, kUsageError, arguments.problem + "; see stationctl help");
  try {
    return carry_out(arguments);
  } catch (const bus::BusError& error) {
    return fail(arguments, kNoBus, error.what());
  }
}

int list(const Arguments& arguments) {
  Client client(arguments);
  SupervisorQuestion question(client);
  const Stations stations =
      client.settle(monotonic_ns() + arguments.timeout_ns, [&question] { question.ask(); });
  const std::vector<Missing> missing = question.missing(stations);
  if (stations.empty() && missing.empty())
    return fail(arguments, kNoStation, no_station_text(arguments, stations));
  const std::int64_t now_ns = monotonic_ns();
  if (arguments.json) {
    print_line(stations_json(stations, missing, now_ns));
  } else {
    for (const std::string& line : stations_table(stations, missing, now_ns, 0)) print_line(line);
    for (const std::string& line : rights_lines(stations)) print_line(line);
  }
  return stations.empty() ? kNoStation : kDone;
}

int describe(const Arguments& arguments) {
  std::string_view digits = arguments.station;
  if (digits.starts_with("ST") || digits.starts_with("st")) digits.remove_prefix(2);
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc{} || end != digits.data() + digits.size() || digits.empty())
    return fail(arguments, kUsageError, "not a code: \"" + arguments.station + "\"; codes look like ST1203");
  const CodeInfo* info = find_code(number);
  if (info == nullptr)
    return fail(arguments, kRefused,
                "no such code: " + code_id(number) +
                    "; one of your own program: stationctl msg STATION describe " + code_id(number));
  if (arguments.json) {
    JsonObject out;
    out.number("code", number).text("severity", name_of(info->severity)).text("name", info->name);
    print_line(out.text("cause", info->cause).text("remedy", info->remedy).str());
    return kDone;
  }
  print_line(code_text(number) + " (" + std::string(name_of(info->severity)) + ")");
  print_line("Cause:  " + std::string(info->cause));
  print_line("Remedy: " + std::string(info->remedy));
  return kDone;
}

}  // namespace stationd::ctl

// Output: what stationctl prints: tables for people, JSON for programs; errors go to standard error.
// Owned by a command.
// The command's thread.
#pragma once

#include <string>
#include <vector>

#include "ctl/arguments.hpp"
#include "ctl/client.hpp"
#include "ctl/json.hpp"
#include "ctl/supervisor.hpp"

namespace stationd::ctl {

enum ExitStatus : int {
  kDone = 0,
  kRefused = 1,      ///< by the station, or it answered with an error
  kNoAnswer = 2,     ///< within the time-out
  kNoStation = 3,    ///< of that name on the bus
  kUsageError = 64,  ///< command line
  kNoBus = 69        ///< DDS could not be set up
};

/// One station as `list` and `watch` show it.
std::string station_json(const Seen& seen, std::int64_t now_ns);
/// {"stations":[...],"missing":[...]}
std::string stations_json(const Stations& stations, const std::vector<Missing>& missing, std::int64_t now_ns);
/// A heading and a line for each station, the missing ones last; none wider than `width` (0: any).
std::vector<std::string> stations_table(const Stations& stations, const std::vector<Missing>& missing,
                                        std::int64_t now_ns, std::size_t width);
/// A line for each controller that the kernel refused real-time rights, with the remedy.
std::vector<std::string> rights_lines(const Stations& stations);
/// One line without heading: what changes while one watches.
std::string station_line(const Seen& seen, std::int64_t now_ns);
std::string missing_line(const Missing& missing, std::int64_t now_ns);
std::string event_json(const bus::Gse& gse);

/// "did you mean" among what was seen.
std::string suggestion_for(const std::string& station, const Stations& stations);
/// "robot did not answer within 2s: ..." with what to look at.
std::string no_answer_text(const Arguments& arguments, const std::string& what, const Stations& stations);
/// "no station robbot ...".
std::string no_station_text(const Arguments& arguments, const Stations& stations);

void print_line(const std::string& text);
/// Once, to standard error, where people read times: the zone they are in.
void say_zone(const Arguments& arguments);
/// Message to standard error, and with --json {"ok":false,"status":...,"message":...} to standard output.
int fail(const Arguments& arguments, ExitStatus status, const std::string& text);

}  // namespace stationd::ctl

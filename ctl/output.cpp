#include "ctl/output.hpp"

#include <cstdio>
#include <set>
#include <utility>

#include "config/units.hpp"
#include "ctl/table.hpp"
#include "dds_bridge/text.hpp"
#include "scan/clock.hpp"
#include "scan/codes.hpp"

namespace stationd::ctl {
namespace {

using bus::code_id;
using bus::code_text;
using bus::printable;
using bus::severity_text;
using bus::short_duration;
using bus::state_text;
using bus::step_text;
using bus::time_text;

/// Status is repeated every 0.1 s; the DDS lease is over after some seconds.
constexpr std::int64_t kAwayAfter_ns = 1'000'000'000;

std::string code_name(std::uint32_t code) {
  const CodeInfo* info = find_code(code);
  return info == nullptr ? "" : std::string(info->name);
}

std::string cause_of(const bus::Status& status) {
  if (status.FAULT != 0) return code_text(status.FAULT);
  if (status.WARNING != 0) return code_text(status.WARNING);
  if (status.STATE != static_cast<std::uint32_t>(StationState::STOPPED)) return "";
  if (status.STOP_CAUSE == 1) return "stopped by order";
  return status.STOP_CAUSE == 2 ? "reset after a fault" : "never started";
}

/// Forced tags first: whoever looks at a station has to know.
std::string remark_of(const bus::Status& status) {
  std::string cause = cause_of(status);
  if (status.FORCED == 0) return cause;
  return "forced " + std::to_string(status.FORCED) + (cause.empty() ? "" : "; " + cause);
}

bool away(const Seen& seen, std::int64_t now_ns) { return now_ns - seen.receipt_ns > kAwayAfter_ns; }

std::string silence_of(std::int64_t age_ns) { return "no Status for " + short_duration(age_ns); }

std::string silence_of(const Missing& missing, std::int64_t now_ns) {
  if (!missing.seen_ns) return "no Status ever, says the supervisor that expects it";
  return silence_of(now_ns - *missing.seen_ns) + ", says the supervisor";
}

std::string state_of(const Seen& seen, std::int64_t now_ns) {
  return away(seen, now_ns) ? "away" : state_text(seen.status.STATE);
}

std::string names_of(const Stations& stations) {
  std::string out;
  for (const auto& [name, seen] : stations) out += (out.empty() ? "" : ", ") + printable(name);
  return out;
}

std::string where(const Arguments& arguments) {
  std::string out = "cell " + arguments.cell + ", domain " + std::to_string(arguments.domain) + ", ";
  if (arguments.interfaces.empty()) return out + "all interfaces";
  std::string list;
  for (const std::string& address : arguments.interfaces) list += (list.empty() ? "" : " and ") + address;
  return out + list;
}

}  // namespace

std::string station_json(const Seen& seen, std::int64_t now_ns) {
  const bus::Status& s = seen.status;
  JsonObject out;
  out.text("station", s.STATION).text("controller", s.CONTROLLER).text("state", state_text(s.STATE));
  out.flag("away", away(seen, now_ns)).flag("ready", s.READY).number("epoch", s.EPOCH);
  out.number("fault", s.FAULT).text("fault_name", code_name(s.FAULT));
  out.number("warning", s.WARNING).text("warning_name", code_name(s.WARNING));
  out.number("forced", s.FORCED)
      .number("stop_cause", s.STOP_CAUSE)
      .number("step", s.STEP)
      .text("step_name", s.STEP_NAME);
  out.number("piece", s.PIECE).number("scans", s.SCANS).number("deadline_misses", s.DEADLINE_MISSES);
  out.number("period_ns", s.PERIOD_NS).number("lateness_p99_ns", s.LATENESS_P99_NS);
  out.number("lateness_max_ns", s.LATENESS_MAX_NS).text("realtime", s.REALTIME);
  out.number("source_time_ns", s.SOURCE_TIME).text("time", bus::iso_time(s.SOURCE_TIME));
  out.number("age_ns", now_ns - seen.receipt_ns);
  return out.str();
}

std::string stations_json(const Stations& stations, const std::vector<Missing>& missing,
                          std::int64_t now_ns) {
  std::vector<std::string> values;
  for (const auto& [name, seen] : stations) values.push_back(station_json(seen, now_ns));
  std::vector<std::string> gone;
  for (const Missing& one : missing) {
    JsonObject out;
    out.text("station", one.station).text("controller", one.controller);
    gone.push_back(out.raw("age_ns", one.seen_ns ? std::to_string(now_ns - *one.seen_ns) : "null").str());
  }
  return JsonObject().raw("stations", json_array(values)).raw("missing", json_array(gone)).str();
}

std::vector<std::string> rights_lines(const Stations& stations) {
  std::set<std::string> lines;
  for (const auto& [name, seen] : stations) {
    const std::string& rights = seen.status.REALTIME;
    if (!rights.starts_with("refused")) continue;
    const CodeInfo* info = find_code(code::realtime_refused);
    lines.insert(bus::printable(seen.status.CONTROLLER) + ": real-time rights " + bus::printable(rights) +
                 ". " + std::string(info->remedy));
  }
  return {lines.begin(), lines.end()};
}

std::vector<std::string> stations_table(const Stations& stations, const std::vector<Missing>& missing,
                                        std::int64_t now_ns, std::size_t width) {
  const std::vector<Column> columns = {{"STATION"},
                                       {"STATE"},
                                       {"STEP", false, 3},
                                       {"PIECE", true, 2},
                                       {"SCANS", true, 5},
                                       {"MISSES", true, 4},
                                       {"LATE p99/max", true, 6},
                                       {"PERIOD", true, 8},
                                       {"CONTROLLER", false, 7},
                                       {"FAULT OR WARNING"}};
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, seen] : stations) {
    const bus::Status& s = seen.status;
    rows.push_back({printable(name), state_of(seen, now_ns), step_text(s),
                    s.PIECE == 0 ? "-" : std::to_string(s.PIECE), std::to_string(s.SCANS),
                    std::to_string(s.DEADLINE_MISSES),
                    short_duration(s.LATENESS_P99_NS) + "/" + short_duration(s.LATENESS_MAX_NS),
                    config::duration_text(s.PERIOD_NS), printable(s.CONTROLLER),
                    away(seen, now_ns) ? silence_of(now_ns - seen.receipt_ns) : remark_of(s)});
  }
  for (const Missing& one : missing)
    rows.push_back({printable(one.station), one.seen_ns ? "away" : "not seen", "-", "-", "-", "-", "-", "-",
                    printable(one.controller), silence_of(one, now_ns)});
  return table_lines(columns, std::move(rows), width);
}

std::string station_line(const Seen& seen, std::int64_t now_ns) {
  const bus::Status& s = seen.status;
  std::string out = time_text(s.SOURCE_TIME) + " " + printable(s.STATION) + " " + state_of(seen, now_ns);
  if (away(seen, now_ns))
    out += ": " + silence_of(now_ns - seen.receipt_ns) + "; it was " + state_text(s.STATE);
  out += " step=" + step_text(s) + " piece=" + std::to_string(s.PIECE) + " scans=" + std::to_string(s.SCANS);
  out += " misses=" + std::to_string(s.DEADLINE_MISSES) + " late_p99=" + short_duration(s.LATENESS_P99_NS);
  out += " fault=" + (s.FAULT == 0 ? "none" : code_id(s.FAULT));
  const std::string remark = remark_of(s);
  return remark.empty() ? out : out + " " + remark;
}

std::string missing_line(const Missing& missing, std::int64_t now_ns) {
  return "--:--:-- " + printable(missing.station) + (missing.seen_ns ? " away: " : " not seen: ") +
         silence_of(missing, now_ns);
}

std::string event_json(const bus::Gse& gse) {
  JsonObject out;
  out.text("station", gse.STATION)
      .number("epoch", gse.EPOCH)
      .number("seq", gse.SEQ)
      .number("code", gse.STATUS);
  out.text("name", code_name(gse.STATUS))
      .text("severity", severity_text(gse.SEVERITY))
      .flag("error", gse.ERROR);
  out.flag("active", gse.ACTIVE).flag("edge", gse.EDGE).number("detail", gse.DETAIL);
  out.number("source_time_ns", gse.SOURCE_TIME).text("time", bus::iso_time(gse.SOURCE_TIME));
  out.text("text", gse.TEXT).text("source", bus::event_source(gse));
  return out.str();
}

std::string suggestion_for(const std::string& station, const Stations& stations) {
  std::vector<std::string_view> names;
  for (const auto& [name, seen] : stations) names.push_back(name);
  names.emplace_back("supervisor");  // it publishes no Status
  return printable(config::suggestion(station, names));
}

std::string no_answer_text(const Arguments& arguments, const std::string& what, const Stations& stations) {
  std::string out =
      arguments.station + " " + what + " within " + config::duration_text(arguments.timeout_ns) + ": ";
  const auto it = stations.find(arguments.station);
  if (it == stations.end())
    return out + "nothing of that name was heard on the bus (" + where(arguments) + ")";
  if (away(it->second, monotonic_ns()))
    return out + "its controller " + printable(it->second.status.CONTROLLER) +
           " has gone silent; look at that daemon (systemctl status, its log) and the network";
  return out + "it is on the bus and its Status says " + state_text(it->second.status.STATE) +
         "; its daemon's log says what became of the order";
}

std::string no_station_text(const Arguments& arguments, const Stations& stations) {
  const std::string here = "(" + where(arguments) + ")";
  if (stations.empty())
    return "no station was seen within " + config::duration_text(arguments.timeout_ns) + " " + here +
           "; check that a daemon runs, and --domain, --cell and --interface against its configuration";
  return "no station \"" + printable(arguments.station) + "\" on the bus " + here + "; there are " +
         names_of(stations) + suggestion_for(arguments.station, stations);
}

void print_line(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fputc('\n', stdout);
  std::fflush(stdout);
}

void say_zone(const Arguments& arguments) {
  if (arguments.json) return;
  const std::string zone = bus::zone_text(utc_offset_ns() + monotonic_ns());
  std::fprintf(stderr, "times are local: %s\n", zone.c_str());
}

int fail(const Arguments& arguments, ExitStatus status, const std::string& text) {
  std::fprintf(stderr, "stationctl: %s\n", text.c_str());
  if (arguments.json)
    print_line(JsonObject()
                   .flag("ok", false)
                   .number("status", static_cast<int>(status))
                   .text("message", text)
                   .str());
  return status;
}

}  // namespace stationd::ctl

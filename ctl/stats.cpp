// stats: how the scans of a station, or of all, keep their time.
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "ctl/client.hpp"
#include "ctl/commands.hpp"
#include "ctl/output.hpp"
#include "ctl/replies.hpp"
#include "ctl/requests.hpp"
#include "ctl/stats_text.hpp"
#include "dds_bridge/text.hpp"
#include "scan/clock.hpp"

namespace stationd::ctl {
namespace {

using bus::printable;

constexpr auto kShown = std::to_array<Figure>({Figure::lateness, Figure::execution, Figure::response});

/// What keeps a station from being shown; status kDone: nothing.
struct Obstacle {
  ExitStatus status = kDone;
  std::string text;
};

Obstacle add_histograms(Client& client, const Arguments& about, StationStats& station) {
  for (const Figure figure : kShown) {
    const auto reply = ask(client, about, "histogram " + std::string(name_of(figure)));
    if (!reply) return {kNoAnswer, no_answer_text(about, "did not send its histogram", client.stations())};
    const std::string text = without_id(reply->BODY);
    auto histogram = reply->ERROR ? std::nullopt : bus::parse_histogram(text);
    if (!histogram) return {kRefused, printable(about.station) + " sent no histogram: " + printable(text)};
    station.histograms.push_back(std::move(*histogram));
  }
  return {};
}

Obstacle look(Client& client, const Arguments& about, std::int64_t until_ns, StationStats& station) {
  const auto heard = [&] {
    const auto it = client.stats_seen().find(about.station);
    if (it == client.stats_seen().end()) return false;
    station.stats = it->second;
    if (const auto status = client.seen().find(about.station); status != client.seen().end())
      station.realtime = status->second.status.REALTIME;
    return true;
  };
  if (!client.wait(until_ns, heard))
    return {kNoAnswer, no_answer_text(about, "published no statistics", client.stations())};
  return about.histogram ? add_histograms(client, about, station) : Obstacle{};
}

/// The stations that are asked for; empty: there is none, or none of that name.
std::vector<std::string> wanted(Client& client, const Arguments& arguments, std::int64_t until_ns) {
  std::vector<std::string> names;
  if (arguments.station.empty()) {
    for (const auto& [name, seen] : client.settle(until_ns)) names.push_back(name);
  } else if (client.wait(until_ns, [&] { return client.seen().contains(arguments.station); })) {
    names.push_back(arguments.station);
  }
  return names;
}

}  // namespace

int stats(const Arguments& arguments) {
  Client client(arguments, false, true);
  const std::int64_t until_ns = monotonic_ns() + arguments.timeout_ns;
  const std::vector<std::string> names = wanted(client, arguments, until_ns);
  if (names.empty()) return fail(arguments, kNoStation, no_station_text(arguments, client.stations()));
  std::vector<StationStats> all;
  Obstacle obstacle;
  for (const std::string& name : names) {
    Arguments about = arguments;
    about.station = name;
    StationStats station;
    const Obstacle now = look(client, about, until_ns, station);
    if (now.status == kDone)
      all.push_back(std::move(station));
    else if (names.size() > 1)
      std::fprintf(stderr, "stationctl: %s\n", now.text.c_str());
    if (now.status != kDone) obstacle = now;
  }
  if (all.empty()) return fail(arguments, obstacle.status, obstacle.text);
  if (arguments.json) {
    print_line(stats_json(all));
    return obstacle.status;
  }
  for (const StationStats& station : all)
    for (const std::string& line : stats_lines(station)) print_line(line);
  return obstacle.status;
}

}  // namespace stationd::ctl

// watch and events: what goes on in the cell, until Ctrl-C or a count.
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "ctl/client.hpp"
#include "ctl/commands.hpp"
#include "ctl/output.hpp"
#include "ctl/supervisor.hpp"
#include "dds_bridge/text.hpp"
#include "scan/clock.hpp"

namespace stationd::ctl {
namespace {

using bus::event_text;

constexpr std::int64_t kSample_ns = 1'000'000'000;   // plain lines and JSON
constexpr std::int64_t kRedraw_ns = 250'000'000;     // a view in a terminal
constexpr std::int64_t kHistory_ns = 1'000'000'000;  // events of the past come within so long

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void end_on_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted.store(true); };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(signal, &action, nullptr);
}

/// False: interrupted, or nobody reads our output any more.
bool go_on() {
  if (interrupted.load()) return false;
  pollfd out{.fd = STDOUT_FILENO, .events = 0, .revents = 0};
  return ::poll(&out, 1, 0) <= 0 || (out.revents & (POLLERR | POLLHUP | POLLNVAL)) == 0;
}

/// Waits in small pieces, so that Ctrl-C acts at once.
void pause_until(Client& client, std::int64_t until_ns) {
  while (go_on() && monotonic_ns() < until_ns)
    client.wait(std::min(until_ns, monotonic_ns() + 50'000'000), [] { return false; });
}

bool in_terminal() {
  const char* kind = std::getenv("TERM");
  return ::isatty(STDOUT_FILENO) == 1 && kind != nullptr && std::strcmp(kind, "dumb") != 0;
}

/// A view that replaces itself, on the terminal's other screen; puts the old one back.
class View {
 public:
  View() { put("\x1b[?1049h\x1b[?25l"); }
  ~View() { put("\x1b[?25h\x1b[?1049l"); }
  View(const View&) = delete;
  View& operator=(const View&) = delete;

  void show(const Stations& stations, const std::vector<Missing>& missing) {
    winsize size{};
    if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) size = {24, 80, 0, 0};
    // One column less: erasing behind a full line would take its end.
    std::vector<std::string> lines = stations_table(stations, missing, monotonic_ns(), size.ws_col - 1U);
    lines.emplace_back();
    lines.emplace_back("Ctrl-C ends");
    if (lines.size() > size.ws_row) lines.resize(size.ws_row);
    std::string out = "\x1b[H";
    for (std::size_t i = 0; i < lines.size(); ++i) out += (i == 0 ? "" : "\r\n") + lines[i] + "\x1b[K";
    put(out + "\x1b[J");
  }

 private:
  static void put(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
  }
};

Stations only(const Stations& stations, const std::string& name) {
  if (name.empty()) return stations;
  Stations out;
  if (const auto it = stations.find(name); it != stations.end()) out.insert(*it);
  return out;
}

/// What is watched: one station, or all of them and those that the supervisor misses.
class Watched {
 public:
  Watched(const Arguments& arguments, Client& client)
      : arguments_(arguments), client_(client), question_(client) {}

  /// False: there is nothing to watch.
  bool find() {
    const std::int64_t until_ns = monotonic_ns() + arguments_.timeout_ns;
    if (arguments_.station.empty())
      client_.settle(until_ns, [this] { question_.ask(); });
    else
      client_.wait(until_ns, [this] { return client_.seen().contains(arguments_.station); });
    return !stations().empty() || !missing().empty();
  }
  Stations stations() { return only(client_.stations(), arguments_.station); }
  std::vector<Missing> missing() {
    return arguments_.station.empty() ? question_.missing(client_.stations()) : std::vector<Missing>{};
  }
  Client& client() { return client_; }

 private:
  const Arguments& arguments_;
  Client& client_;
  SupervisorQuestion question_;
};

void print_sample(const Arguments& arguments, Watched& watched) {
  const std::int64_t now_ns = monotonic_ns();
  if (arguments.json) return print_line(stations_json(watched.stations(), watched.missing(), now_ns));
  for (const auto& [name, seen] : watched.stations()) print_line(station_line(seen, now_ns));
  for (const Missing& one : watched.missing()) print_line(missing_line(one, now_ns));
}

void watch_in_terminal(const Arguments& arguments, Watched& watched) {
  View view;
  for (std::uint64_t n = 0; go_on() && (!arguments.count || n < *arguments.count); ++n) {
    view.show(watched.stations(), watched.missing());
    pause_until(watched.client(), monotonic_ns() + kRedraw_ns);
  }
}

void watch_in_lines(const Arguments& arguments, Watched& watched) {
  say_zone(arguments);
  std::int64_t due_ns = monotonic_ns();
  for (std::uint64_t n = 0; go_on() && (!arguments.count || n < *arguments.count); ++n) {
    pause_until(watched.client(), due_ns);
    if (go_on()) print_sample(arguments, watched);
    due_ns += kSample_ns;
  }
}

/// Lists each event once.
class EventLister {
 public:
  explicit EventLister(const Arguments& arguments) : arguments_(arguments) {}

  void take(std::vector<bus::Gse> fresh) {
    for (bus::Gse& gse : fresh) {
      const bool numbered = gse.SEQ != 0;  // a Table 4 writer numbers none
      if (numbered && !seen_.emplace(gse.STATION, gse.EPOCH, gse.SEQ).second) continue;
      waiting_.push_back(std::move(gse));
    }
  }

  bool waiting() const { return !waiting_.empty(); }

  /// Prints what waits, by time; at most the last (`newest`) or first `limit` of it. How many were printed.
  std::uint64_t print(std::uint64_t limit, bool newest) {
    std::ranges::stable_sort(waiting_, {}, &bus::Gse::SOURCE_TIME);
    const auto count = static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(limit, waiting_.size()));
    const auto first = newest ? waiting_.end() - count : waiting_.begin();
    std::for_each(first, first + count, [this](const bus::Gse& gse) {
      print_line(arguments_.json ? event_json(gse) : event_text(gse));
    });
    waiting_.clear();
    return static_cast<std::uint64_t>(count);
  }

 private:
  const Arguments& arguments_;
  std::set<std::tuple<std::string, std::uint32_t, std::uint32_t>> seen_;
  std::vector<bus::Gse> waiting_;
};

}  // namespace

int watch(const Arguments& arguments) {
  end_on_signals();
  Client client(arguments);
  Watched watched(arguments, client);
  if (!watched.find()) return fail(arguments, kNoStation, no_station_text(arguments, client.stations()));
  if (!arguments.json && in_terminal()) {
    watch_in_terminal(arguments, watched);
  } else {
    watch_in_lines(arguments, watched);
  }
  return kDone;
}

int events(const Arguments& arguments) {
  end_on_signals();
  Client client(arguments, true);
  const std::int64_t history_ns = monotonic_ns() + std::min(arguments.timeout_ns, kHistory_ns);
  EventLister lister(arguments);
  pause_until(client, history_ns);
  lister.take(client.take_events());
  std::uint64_t left = arguments.count.value_or(UINT64_MAX);
  const bool any = lister.waiting();
  if (any || arguments.follow) say_zone(arguments);
  left -= lister.print(left, !arguments.follow);
  if (!arguments.follow) {
    if (client.stations().empty()) return fail(arguments, kNoStation, no_station_text(arguments, {}));
    if (!any) std::fprintf(stderr, "no events\n");  // as JSON, one a line: no line
    return kDone;
  }
  while (left > 0 && go_on()) {
    pause_until(client, monotonic_ns() + 50'000'000);
    lister.take(client.take_events());
    left -= lister.print(left, false);
  }
  return kDone;
}

}  // namespace stationd::ctl

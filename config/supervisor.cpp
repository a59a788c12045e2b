#include <algorithm>

#include "config/loading.hpp"

namespace stationd::config {
namespace {

void load_station_names(const Section& section, std::vector<std::string>& stations) {
  const Member* given = section.member("stations");
  const bool list = given != nullptr && given->value.kind == Node::Kind::array && !given->value.items.empty();
  if (!list) {
    section.problem("stations",
                    (given == nullptr ? std::string("missing") : "found " + describe(given->value)) +
                        "; required is a list of stations, as in [\"storage\", \"sealer\"]");
    return;
  }
  for (const Node& item : given->value.items) {
    const bool good = item.kind == Node::Kind::string && is_name(item.text);
    if (!good)
      section.problem_at(
          item.position, "stations",
          "found " + describe(item) + "; allowed are names of stations: letters, digits, - and _");
    else if (std::find(stations.begin(), stations.end(), item.text) != stations.end())
      section.problem_at(item.position, "stations",
                         "found \"" + item.text + "\" a second time; names must differ");
    else
      stations.push_back(item.text);
  }
}

}  // namespace

Result<SupervisorConfiguration> parse_supervisor(std::string_view text, const std::filesystem::path& file) {
  constexpr std::int64_t ms = 1'000'000;
  Problems problems(file);
  SupervisorConfiguration supervisor;
  supervisor.file = file;
  const Node root = parse_toml(text, problems);
  if (root.members.empty() && !problems.empty()) return {std::nullopt, problems.take()};
  if (is_other_kind(root, FileKind::supervisor, problems)) return {std::nullopt, problems.take()};
  report_unknown_sections(root, supervisor_sections(), problems);
  load_log(root, supervisor.log_level, problems);
  load_bus(root, supervisor.bus, nullptr, problems);
  const Node& table = single_table(root, "supervisor", true, problems);
  if (root.find("supervisor") != nullptr) {
    const Section section(table, kSupervisorKeys, "supervisor", problems);
    section.name("name", supervisor.name);
    load_station_names(section, supervisor.stations);
    load_state_dir(section, supervisor.state_dir);
    std::string journal = "supervisor.journal";
    if (section.text("journal", journal) && (journal.empty() || journal.find('\0') != std::string::npos))
      section.problem("journal", "found \"\"; allowed is the name of a file");
    supervisor.journal_file = supervisor.state_dir / journal;  // an absolute name replaces the folder
    section.duration("start_repeat", supervisor.start_repeat_ns, {50 * ms, 60'000 * ms});
    section.duration("stale_after", supervisor.stale_after_ns, {100 * ms, 60'000 * ms});
  }
  supervisor.bus.name = supervisor.name;
  if (!problems.empty()) return {std::nullopt, problems.take()};
  return {std::move(supervisor), {}};
}

}  // namespace stationd::config

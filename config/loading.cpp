#include "config/loading.hpp"

#include <algorithm>

namespace stationd::config {
namespace {

std::string heading_of(std::string_view name, bool list) {
  return list ? "[[" + std::string(name) + "]]" : "[" + std::string(name) + "]";
}

}  // namespace

void report_unknown_sections(const Node& root, std::span<const SectionKeys* const> sections,
                             Problems& problems) {
  std::vector<std::string_view> names;
  std::string headings;
  for (const SectionKeys* section : sections) {
    if (section->heading.find('.') != std::string_view::npos) continue;
    names.push_back(section->name);
    headings += (headings.empty() ? "" : ", ") + std::string(section->heading);
  }
  for (const Member& given : root.members) {
    if (std::find(names.begin(), names.end(), given.key) != names.end()) continue;
    const std::string hint = suggestion(given.key, names);
    problems.add(given.position, given.key,
                 "unknown section" + (hint.empty() ? "; allowed are " + headings : hint));
  }
}

bool is_other_kind(const Node& root, FileKind wanted, Problems& problems) {
  static constexpr std::array<std::string_view, 4> of_controllers = {"controller", "task", "device",
                                                                     "station"};
  const Member* supervisor = root.find("supervisor");
  const Member* controller = nullptr;
  for (const std::string_view name : of_controllers)
    if (controller == nullptr) controller = root.find(name);
  const Member* stray = wanted == FileKind::controller ? supervisor : controller;
  const Member* own = wanted == FileKind::controller ? controller : supervisor;
  if (stray == nullptr || own != nullptr) return false;
  const std::string program = wanted == FileKind::controller ? "stationd-supervisor" : "stationd";
  problems.add(stray->position, {},
               "this is a " + std::string(wanted == FileKind::controller ? "supervisor" : "controller") +
                   "'s file; check it with " + program + " --check " + problems.file().string() +
                   ", and run it with " + program);
  return true;
}

const Node& single_table(const Node& root, std::string_view name, bool required, Problems& problems) {
  static const Node empty;
  const Member* given = root.find(name);
  if (given == nullptr) {
    if (required) problems.add({1, 1}, name, "missing; required is one section " + heading_of(name, false));
    return empty;
  }
  if (given->value.kind == Node::Kind::table) return given->value;
  problems.add(given->position, name,
               "found " + describe(given->value) + "; allowed is one section " + heading_of(name, false));
  return empty;
}

std::vector<const Node*> table_list(const Node& root, std::string_view name, bool required,
                                    Problems& problems) {
  const Member* given = root.find(name);
  std::vector<const Node*> tables;
  if (given == nullptr) {
    if (required)
      problems.add({1, 1}, name, "missing; required is at least one section " + heading_of(name, true));
    return tables;
  }
  const bool list = given->value.kind == Node::Kind::array;
  if (list)
    for (const Node& item : given->value.items)
      if (item.kind == Node::Kind::table) tables.push_back(&item);
  if (!list || tables.size() != given->value.items.size() || tables.empty())
    problems.add(given->position, name,
                 "found " + describe(given->value) + "; allowed are sections " + heading_of(name, true));
  return tables;
}

std::string path_of(std::string_view section, const Node& table, std::size_t index) {
  const Member* name = table.find("name");
  if (name != nullptr && name->value.kind == Node::Kind::string && is_name(name->value.text))
    return std::string(section) + "." + name->value.text;
  return std::string(section) + "[" + std::to_string(index + 1) + "]";
}

bool is_taken(const Section& section, const std::string& name, std::vector<std::string>& taken) {
  if (std::find(taken.begin(), taken.end(), name) != taken.end()) {
    section.problem("name", "found \"" + name + "\" a second time; names must differ");
    return true;
  }
  taken.push_back(name);
  return false;
}

void load_log(const Node& root, LogLevel& level, Problems& problems) {
  static constexpr std::array<std::pair<std::string_view, LogLevel>, 4> levels = {
      {{"debug", LogLevel::debug},
       {"info", LogLevel::info},
       {"warning", LogLevel::warning},
       {"error", LogLevel::error}}};
  Section(single_table(root, "log", false, problems), kLogKeys, "log", problems)
      .choice("level", level, levels);
}

void load_state_dir(const Section& section, std::filesystem::path& dir) {
  const char* given = std::getenv("STATE_DIRECTORY");
  std::string_view first = given != nullptr ? std::string_view(given) : std::string_view();
  first = first.substr(0, first.find(':'));  // systemd lists several when the unit asks for several
  dir = first.empty() ? std::filesystem::path("/var/lib/stationd") : std::filesystem::path(first);
  section.absolute_path("state_dir", dir);
}

std::variant<std::monostate, bool, std::int64_t, double, std::string> raw_value(const Node& node) {
  switch (node.kind) {
    case Node::Kind::boolean: return node.boolean;
    case Node::Kind::integer: return node.integer;
    case Node::Kind::number: return node.number;
    case Node::Kind::string: break;
    default: return std::monostate{};
  }
  if (node.expanded && (node.text == "true" || node.text == "false")) return node.text == "true";
  if (const auto integer = parse_integer(node.text); node.expanded && integer) return *integer;
  if (const auto number = parse_number(node.text); node.expanded && number) return *number;
  return node.text;
}

std::string mapping_path(const StationConfig& station, io::Direction direction, std::string_view tag) {
  std::string path = "station." + station.name;
  path += direction == io::Direction::input ? ".inputs" : ".outputs";
  if (!tag.empty()) path.append(".").append(tag);
  return path;
}

}  // namespace stationd::config

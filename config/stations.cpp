#include <algorithm>

#include "config/loading.hpp"

namespace stationd::config {
namespace {

std::vector<std::string_view> names_of_devices(const Configuration& configuration) {
  std::vector<std::string_view> names;
  for (const io::DeviceOptions& device : configuration.devices) names.push_back(device.name);
  return names;
}

/// The mapping's table: itself, or for the short form `tag = "device:di:0"` one made of it.
Node as_table(const Member& given, std::string_view only_key) {
  if (given.value.kind == Node::Kind::table) return given.value;
  Node table;
  table.position = given.value.position;
  table.members.push_back({std::string(only_key), given.value.position, given.value});
  return table;
}

bool load_type(const Section& section, std::optional<TagType>& type) {
  std::string text;
  if (!section.text("type", text)) return false;
  type = parse_type(text);
  if (type && *type != TagType::STRING) return true;
  std::vector<std::string_view> names;
  std::string allowed;
  for (int i = 0; i < static_cast<int>(TagType::STRING); ++i) {
    names.push_back(name_of(static_cast<TagType>(i)));
    allowed += (i == 0 ? "" : ", ") + std::string(names.back());
  }
  const std::string hint = suggestion(text, names);
  section.problem("type", "found \"" + text + "\"; allowed are " + allowed + hint);
  type.reset();
  return false;
}

void check_table(const Section& section, const TagMapping& mapping, io::Direction direction) {
  const io::Table table = mapping.point.table;
  const bool writable = table == io::Table::coil || table == io::Table::holding_register;
  if (direction == io::Direction::output && !writable)
    section.problem("at", "found the table " + std::string(short_name(table)) +
                              ", which can only be read; allowed for outputs are co and hr");
  if (!mapping.type) return;
  if (io::is_bits(table) != (*mapping.type == TagType::BOOL))
    section.problem("type", "found " + std::string(name_of(*mapping.type)) + " in the table " +
                                std::string(short_name(table)) +
                                "; allowed is BOOL in co and di, numbers in ir and hr");
}

void load_place(const Section& section, const Configuration& configuration, TagMapping& mapping) {
  std::string text, error;
  if (!section.text("at", text)) return;
  mapping.at_position = section.position("at");
  const auto place = parse_point(text, error);
  if (!place) {
    section.problem("at", error);
    return;
  }
  const auto devices = names_of_devices(configuration);
  if (configuration.device(place->device) == nullptr) {
    section.problem("at", "found the device \"" + place->device + "\", which there is not" +
                              suggestion(place->device, devices));
    return;
  }
  mapping.device = place->device;
  mapping.point.table = place->table;
  mapping.point.address = place->address;
}

void load_max_age(const Section& section, const Configuration& configuration, TagMapping& mapping) {
  const io::DeviceOptions* device = configuration.device(mapping.device);
  mapping.max_age_ns = device != nullptr ? device->stale_after_ns : 0;
  mapping.max_age_position = section.position("max_age");
  const std::int64_t least_ns = device != nullptr ? device->period_ns : 1;
  const std::int64_t most_ns = device != nullptr ? device->bad_after_ns - 1 : 3'600'000'000'000;
  section.duration("max_age", mapping.max_age_ns, {least_ns, most_ns});
}

void load_safe(const Section& section, TagMapping& mapping) {
  const Member* given = section.member("safe");
  if (given == nullptr) return;
  mapping.safe_given = true;
  mapping.safe_position = given->value.position;
  mapping.safe_raw = raw_value(given->value);
  if (std::holds_alternative<std::monostate>(mapping.safe_raw))
    section.problem("safe", "found " + describe(given->value) + "; allowed is a value or \"hold\"");
}

void load_mappings(const Member* group, io::Direction direction, const Configuration& configuration,
                   StationConfig& station, Problems& problems) {
  if (group == nullptr) return;
  const bool input = direction == io::Direction::input;
  if (group->value.kind != Node::Kind::table) {
    problems.add(
        group->position, mapping_path(station, direction, {}),
        "found " + describe(group->value) + "; allowed is a section of tags, as in conveyor = \"io-1:co:0\"");
    return;
  }
  for (const Member& given : group->value.members) {
    TagMapping mapping;
    mapping.tag = given.key;
    mapping.position = given.position;
    mapping.point.tag = station.name + "." + given.key;
    mapping.point.direction = direction;
    const Node table = as_table(given, "at");
    const Section section(table, input ? kInputKeys : kOutputKeys,
                          mapping_path(station, direction, given.key), problems);
    if (!is_tag_name(given.key))
      problems.add(given.position, section.path(),
                   "no tag has such a name; allowed are letters, digits, _ and .");
    load_place(section, configuration, mapping);
    mapping.type_position = section.position("type");
    load_type(section, mapping.type);
    mapping.point.type =
        mapping.type.value_or(io::is_bits(mapping.point.table) ? TagType::BOOL : TagType::UINT);
    if (input)
      load_max_age(section, configuration, mapping);
    else
      load_safe(section, mapping);
    if (!mapping.device.empty()) check_table(section, mapping, direction);
    (input ? station.inputs : station.outputs).push_back(std::move(mapping));
  }
}

/// A value of the tag, in whatever kind; the program's type decides later.
void load_value(const Section& section, std::string_view key, RawValue& raw, Position& position) {
  const Member* given = section.member(key);
  if (given == nullptr) return;
  position = given->value.position;
  raw = raw_value(given->value);
  if (std::holds_alternative<std::monostate>(raw))
    section.problem(key,
                    "found " + describe(given->value) + "; allowed is a number, true, false or a duration");
}

/// Tags of the program's own, `[station.parameters]` or `[station.tags]`.
void load_own_tags(const Member* group, const SectionKeys& keys, std::string_view example,
                   const StationConfig& station, std::vector<ParameterConfig>& out, Problems& problems) {
  if (group == nullptr) return;
  const std::string path = "station." + station.name + "." + std::string(keys.name);
  if (group->value.kind != Node::Kind::table) {
    problems.add(group->position, path,
                 "found " + describe(group->value) + "; allowed is a section of values, as in " +
                     std::string(example));
    return;
  }
  for (const Member& given : group->value.members) {
    const Node table = as_table(given, "value");
    const Section section(table, keys, path + "." + given.key, problems);
    ParameterConfig parameter;
    parameter.tag = given.key;
    parameter.position = parameter.value_position = given.position;
    load_type(section, parameter.type);
    const bool said = section.boolean("writable", parameter.writable);
    load_value(section, "min", parameter.raw_min, parameter.min_position);
    load_value(section, "max", parameter.raw_max, parameter.max_position);
    if (&keys == &kParameterKeys) {
      load_value(section, "value", parameter.raw, parameter.value_position);
      if (!section.has("value") && !section.has("min") && !section.has("max") && !section.has("writable"))
        section.problem("value", "missing; required is the parameter's value");
    } else if (said && !parameter.writable) {
      section.problem("writable", "found false; allowed is true, or the tag left out");
    }
    out.push_back(std::move(parameter));
  }
}

void load_task_name(const Section& section, const Configuration& configuration, StationConfig& station) {
  if (!section.has("task")) {
    if (configuration.tasks.size() == 1) station.task = configuration.tasks.front().name;
    if (configuration.tasks.size() > 1)
      section.problem("task", "missing; required is one of the tasks, since there are several");
    return;
  }
  if (!section.text("task", station.task) || configuration.task(station.task) != nullptr) return;
  std::vector<std::string_view> names;
  for (const TaskConfig& task : configuration.tasks) names.push_back(task.name);
  section.problem("task", "found the task \"" + station.task + "\", which there is not" +
                              suggestion(station.task, names));
}

void load_neighbours(const Section& section, StationConfig& station) {
  for (auto [key, out] : {std::pair<std::string_view, std::string*>{"upstream", &station.upstream},
                          std::pair<std::string_view, std::string*>{"downstream", &station.downstream}}) {
    section.name(key, *out);
    if (!out->empty() && *out == station.name)
      section.problem(key, "found the station itself; allowed is another station, or the key left out");
  }
}

/// PV-2: at least four publications within the deadline, and no task publishes more often than it scans.
void check_publication_rate(const Section& section, const Configuration& configuration,
                            const StationConfig& station) {
  const TaskConfig* task = configuration.task(station.task);
  if (task == nullptr || task->period_ns <= configuration.bus.deadline_ns / 4) return;
  section.problem("task", "found the period " + duration_text(task->period_ns) + " of task \"" + task->name +
                              "\"; allowed is at most a quarter of bus.deadline, which is " +
                              duration_text(configuration.bus.deadline_ns));
}

}  // namespace

void load_stations(const Node& root, Configuration& configuration, Problems& problems) {
  static constexpr std::array<std::pair<std::string_view, OnRestart>, 2> restarts = {
      {{"stopped", OnRestart::stopped}, {"resume", OnRestart::resume}}};
  std::vector<std::string> names;
  const auto tables = table_list(root, "station", true, problems);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const Section section(*tables[i], kStationKeys, path_of("station", *tables[i], i), problems);
    StationConfig station;
    station.position = tables[i]->position;
    section.name("name", station.name);
    if (!station.name.empty()) is_taken(section, station.name, names);
    load_task_name(section, configuration, station);
    check_publication_rate(section, configuration, station);
    section.name("program", station.program);
    station.program_position = section.position("program");
    section.choice("on_restart", station.on_restart, restarts);
    load_neighbours(section, station);
    load_mappings(section.member("inputs"), io::Direction::input, configuration, station, problems);
    load_mappings(section.member("outputs"), io::Direction::output, configuration, station, problems);
    load_own_tags(section.member("parameters"), kParameterKeys, "step_timeout = \"5s\"", station,
                  station.parameters, problems);
    load_own_tags(section.member("tags"), kTagKeys, "pieces = { writable = true }", station, station.tags,
                  problems);
    configuration.stations.push_back(std::move(station));
  }
}

}  // namespace stationd::config

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include "config/loading.hpp"

namespace stationd::config {
namespace {

constexpr std::int64_t kUs = 1'000, kMs = 1'000'000, kS = 1'000'000'000;
constexpr std::size_t kMaxFileBytes = 4 << 20;

void load_controller_section(const Node& root, Configuration& configuration, Problems& problems) {
  const Section section(single_table(root, "controller", true, problems), kControllerKeys, "controller",
                        problems);
  if (root.find("controller") == nullptr) return;
  section.name("name", configuration.name);
  load_state_dir(section, configuration.state_dir);
  section.boolean("require_realtime", configuration.require_realtime);
  section.boolean("keep_cpus_awake", configuration.keep_cpus_awake);
  section.boolean("restart_on_stuck", configuration.restart_on_stuck);
}

void load_interfaces(const Section& section, bus::Options& options) {
  const Member* given = section.member("interfaces");
  if (given == nullptr) return;
  std::vector<std::string> addresses;
  bool good = given->value.kind == Node::Kind::array;
  for (const Node& item : given->value.items) {
    if (item.kind == Node::Kind::string && is_ipv4(item.text)) {
      addresses.push_back(item.text);
    } else {
      section.problem_at(item.position, "interfaces",
                         "found " + describe(item) + "; allowed are IPv4 addresses, as in [\"127.0.0.1\"]");
    }
  }
  if (!good)
    section.problem("interfaces", "found " + describe(given->value) +
                                      "; allowed is a list of IPv4 addresses, as in [\"127.0.0.1\"]");
  else
    options.interfaces = std::move(addresses);
}

void load_pv_limits(const Section& section, const bus::Options& options, Configuration& configuration) {
  const std::int64_t quarter_ns = options.deadline_ns / 4;
  configuration.pv_heartbeat_ns = std::min(100 * kMs, quarter_ns);
  section.duration("heartbeat", configuration.pv_heartbeat_ns, {1 * kMs, quarter_ns});
  configuration.bus_stale_after_ns = options.deadline_ns;
  section.duration("stale_after", configuration.bus_stale_after_ns, {10 * kMs, 3600 * kS});
  configuration.bus_bad_after_ns = 4 * configuration.bus_stale_after_ns;
  section.duration("bad_after", configuration.bus_bad_after_ns,
                   {configuration.bus_stale_after_ns + 1, 24 * 3600 * kS});
}

void load_heartbeat(const Section& device, io::DeviceOptions& options) {
  const Member* given = device.member("heartbeat");
  if (given == nullptr) return;
  if (given->value.kind != Node::Kind::table) {
    device.problem("heartbeat",
                   "found " + describe(given->value) + "; allowed is { register = 100, period = \"100ms\" }");
    return;
  }
  const Section section(given->value, kDeviceHeartbeatKeys, device.path() + ".heartbeat", device.problems());
  section.integer("register", options.heartbeat_register, 0, 65535);
  options.heartbeat_period_ns = std::max(100 * kMs, options.period_ns);
  section.duration("period", options.heartbeat_period_ns, {options.period_ns, 60 * kS});
  if (options.kind != io::DeviceKind::modbus)
    device.problem("heartbeat", "found with another kind than modbus; only a Modbus device has one");
}

void load_address(const Section& section, io::DeviceOptions& options) {
  if (!section.has("address")) {
    if (options.kind == io::DeviceKind::modbus)
      section.problem_at(section.node().position, "address",
                         "missing; required is an IPv4 address and a port, as in \"192.168.0.10:502\"");
    return;
  }
  std::string text, error;
  if (!section.text("address", text)) return;
  if (options.kind != io::DeviceKind::modbus) {
    section.problem("address", "found with another kind than modbus; only a Modbus device has one");
    return;
  }
  if (const auto address = parse_host_port(text, error)) {
    options.host = address->host;
    options.port = address->port;
  } else {
    section.problem("address", error);
  }
}

void load_device(const Section& section, io::DeviceOptions& options) {
  static constexpr std::array<std::pair<std::string_view, io::DeviceKind>, 3> kinds = {
      {{"modbus", io::DeviceKind::modbus},
       {"simulated", io::DeviceKind::simulated},
       {"null", io::DeviceKind::null}}};
  section.choice("kind", options.kind, kinds);
  load_address(section, options);
  section.integer("unit", options.unit, 1, 247);
  section.duration("period", options.period_ns, {1 * kMs, 60 * kS});
  section.duration("timeout", options.timeout_ns, {1 * kMs, 10 * kS});
  options.stale_after_ns = std::max(50 * kMs, 5 * options.period_ns);
  section.duration("stale_after", options.stale_after_ns, {options.period_ns, 3600 * kS});
  options.bad_after_ns = 10 * options.stale_after_ns;
  section.duration("bad_after", options.bad_after_ns, {options.stale_after_ns + 1, 24 * 3600 * kS});
  load_heartbeat(section, options);
}

bool same_unit(const io::DeviceOptions& a, const io::DeviceOptions& b) {
  if (a.kind != b.kind || a.unit != b.unit || a.kind == io::DeviceKind::null) return false;
  return a.kind == io::DeviceKind::simulated || (a.host == b.host && a.port == b.port);
}

void load_recipe_values(const Section& section, Recipe& recipe) {
  for (const Member& given : section.node().members) {
    if (given.key == "code" || given.key == "name") continue;
    const Node& value = given.value;
    const auto raw = raw_value(value);
    if (const auto* number = std::get_if<std::int64_t>(&raw)) {
      recipe.values.emplace_back(given.key, *number);
    } else if (const auto* text = std::get_if<std::string>(&raw);
               text != nullptr && parse_duration_ns(*text)) {
      recipe.values.emplace_back(given.key, *parse_duration_ns(*text));
    } else {
      section.problem(given.key, "found " + describe(value) +
                                     "; allowed is a whole number, or a duration with its "
                                     "unit, as in \"300ms\"");
    }
  }
}

}  // namespace

void load_bus(const Node& root, bus::Options& options, Configuration* controller, Problems& problems) {
  const Section section(single_table(root, "bus", false, problems), kBusKeys, "bus", problems);
  section.integer("domain", options.domain, 0, 99);
  std::string cell;
  if (section.text("cell", cell)) {
    if (cell.empty() || cell.size() > 255 || cell.find_first_of("*?[") != std::string::npos)
      section.problem("cell",
                      "found \"" + cell + "\"; allowed is a name of at most 255 bytes without *, ? and [");
    else
      options.cell = cell;
  }
  load_interfaces(section, options);
  section.duration("lease", options.lease_ns, {50 * kMs, 60 * kS});
  section.duration("deadline", options.deadline_ns, {10 * kMs, 3600 * kS});
  section.size("max_body", options.max_body_bytes, 256, 1 << 20);
  section.integer("request_depth", options.request_depth, 64, 65536);
  section.integer("event_depth", options.event_depth, 64, 65536);
  if (controller != nullptr) {
    load_pv_limits(section, options, *controller);
    return;
  }
  for (const std::string_view key : {"heartbeat", "stale_after", "bad_after"})
    if (section.has(key)) section.problem(key, "found in a supervisor's file; only controllers have it");
}

void load_tasks(const Node& root, Configuration& configuration, Problems& problems) {
  static constexpr std::array<std::pair<std::string_view, Overrun>, 2> overruns = {
      {{"skip", Overrun::skip}, {"fault", Overrun::fault}}};
  std::vector<std::string> names;
  const auto tables = table_list(root, "task", true, problems);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const Section section(*tables[i], kTaskKeys, path_of("task", *tables[i], i), problems);
    TaskConfig task;
    task.position = tables[i]->position;
    section.name("name", task.name);
    if (!task.name.empty()) is_taken(section, task.name, names);
    section.duration("period", task.period_ns, {250 * kUs, 60 * kS});
    section.duration("phase", task.phase_ns, {0, task.period_ns - 1});
    section.integer("priority", task.priority, 1, 95);
    section.integer("cpu", task.cpu, 0, 1023);
    section.choice("overrun", task.overrun, overruns);
    task.watchdog_ns = std::max(10 * task.period_ns, 100 * kMs);
    section.duration("watchdog", task.watchdog_ns, {task.period_ns, 600 * kS});
    section.duration("spin", task.spin_ns, {0, task.period_ns - 1});
    configuration.tasks.push_back(std::move(task));
  }
}

void load_devices(const Node& root, Configuration& configuration, Problems& problems) {
  std::vector<std::string> names;
  const auto tables = table_list(root, "device", false, problems);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const Section section(*tables[i], kDeviceKeys, path_of("device", *tables[i], i), problems);
    io::DeviceOptions options;
    section.name("name", options.name);
    if (!options.name.empty()) is_taken(section, options.name, names);
    load_device(section, options);
    for (const io::DeviceOptions& other : configuration.devices)
      if (same_unit(other, options))
        section.problem("unit", "found the unit of device \"" + other.name +
                                    "\" a second time; allowed is one device "
                                    "per unit");
    configuration.devices.push_back(std::move(options));
  }
}

void load_plant(const Node& root, Configuration& configuration, Problems& problems) {
  const Section section(single_table(root, "plant", false, problems), kPlantKeys, "plant", problems);
  io::PlantOptions& plant = configuration.plant;
  section.integer("seed", plant.seed, 0, std::numeric_limits<std::int64_t>::max());
  section.integer("pallets", plant.pallets, 0, std::numeric_limits<std::uint32_t>::max());
  section.duration("step", plant.step_ns, {100 * kUs, 100 * kMs});
  section.number("speed", plant.speed, 0.01, 1000);
  section.text("ledger", plant.ledger_file);
}

void load_recipes(const Node& root, Configuration& configuration, Problems& problems) {
  const auto tables = table_list(root, "recipe", false, problems);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const Section section(*tables[i], kRecipeKeys, "recipe[" + std::to_string(i + 1) + "]", problems);
    Recipe recipe;
    section.text("name", recipe.name);
    constexpr std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
    if (!section.integer("code", recipe.code, 1, most)) recipe.code = most - static_cast<std::uint32_t>(i);
    const auto same = [&](const Recipe& other) { return other.code == recipe.code; };
    const bool twice = std::ranges::any_of(configuration.recipes, same);
    if (twice)
      section.problem("code", "found " + std::to_string(recipe.code) + " a second time; codes must differ");
    load_recipe_values(section, recipe);
    // What is reported here is kept from the programs, each of which would report it again.
    if (!twice) configuration.recipes.push_back(std::move(recipe));
  }
}

const TaskConfig* Configuration::task(std::string_view task_name) const {
  for (const TaskConfig& candidate : tasks)
    if (candidate.name == task_name) return &candidate;
  return nullptr;
}

const io::DeviceOptions* Configuration::device(std::string_view device_name) const {
  for (const io::DeviceOptions& candidate : devices)
    if (candidate.name == device_name) return &candidate;
  return nullptr;
}

Result<Configuration> parse_controller(std::string_view text, const std::filesystem::path& file,
                                       const ProgramCatalogue* programs) {
  Problems problems(file);
  Configuration configuration;
  configuration.file = file;
  const Node root = parse_toml(text, problems);
  if (root.members.empty() && !problems.empty()) return {std::nullopt, problems.take()};
  if (is_other_kind(root, FileKind::controller, problems)) return {std::nullopt, problems.take()};
  report_unknown_sections(root, controller_sections(), problems);
  load_controller_section(root, configuration, problems);
  load_log(root, configuration.log_level, problems);
  load_bus(root, configuration.bus, &configuration, problems);
  configuration.bus.name = configuration.name;
  load_tasks(root, configuration, problems);
  load_devices(root, configuration, problems);
  load_plant(root, configuration, problems);
  load_recipes(root, configuration, problems);
  load_stations(root, configuration, problems);
  if (programs != nullptr)
    check_programs(configuration, *programs, problems);
  else
    check_overlaps(configuration, problems);
  if (!problems.empty()) return {std::nullopt, problems.take()};
  return {std::move(configuration), {}};
}

namespace {

/// The whole file, or why not.
std::optional<std::string> read_file(const std::filesystem::path& file, std::string& error) {
  std::error_code code;
  if (std::filesystem::is_directory(file, code)) {
    error = "is a directory; a file is needed";
    return std::nullopt;
  }
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    error = std::string("cannot be read: ") + std::strerror(errno);
    return std::nullopt;
  }
  std::string text(kMaxFileBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (in.bad() || text.size() > kMaxFileBytes) {
    error = text.size() > kMaxFileBytes ? "is larger than 4 MiB" : "cannot be read to its end";
    return std::nullopt;
  }
  return text;
}

template <class T, class Parse> Result<T> load(const std::filesystem::path& file, const Parse& parse) {
  std::string error;
  const auto text = read_file(file, error);
  if (!text) return {std::nullopt, {{Position{}, message(file, {}, {}, error)}}};
  return parse(*text);
}

}  // namespace

Result<Configuration> load_controller(const std::filesystem::path& file, const ProgramCatalogue* programs) {
  return load<Configuration>(file,
                             [&](const std::string& text) { return parse_controller(text, file, programs); });
}

Result<SupervisorConfiguration> load_supervisor(const std::filesystem::path& file) {
  return load<SupervisorConfiguration>(file,
                                       [&](const std::string& text) { return parse_supervisor(text, file); });
}

}  // namespace stationd::config

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "config/loading.hpp"
#include "scan/error.hpp"

namespace stationd::config {
namespace {

using Raw = RawValue;

bool is_real(TagType type) { return type == TagType::REAL || type == TagType::LREAL; }

double real_of(TagType type, Slot slot) {
  return type == TagType::REAL ? static_cast<double>(from_slot<float>(slot)) : from_slot<double>(slot);
}

Slot real_slot(TagType type, double value) {
  return type == TagType::REAL ? to_slot(static_cast<float>(value)) : to_slot(value);
}

std::string value_text(TagType type, Slot slot) {
  if (is_real(type)) return std::to_string(real_of(type, slot));
  if (type == TagType::TIME) return "\"" + duration_text(static_cast<std::int64_t>(slot)) + "\"";
  if (type == TagType::BOOL) return slot != 0 ? "true" : "false";
  return std::to_string(static_cast<std::int64_t>(slot));
}

std::string raw_text(const Raw& raw) {
  if (const auto* flag = std::get_if<bool>(&raw)) return *flag ? "true" : "false";
  if (const auto* number = std::get_if<std::int64_t>(&raw)) return std::to_string(*number);
  if (const auto* number = std::get_if<double>(&raw)) return std::to_string(*number);
  if (const auto* text = std::get_if<std::string>(&raw)) return "\"" + *text + "\"";
  return "nothing";
}

/// Least and greatest value that the tag takes, in its own encoding.
std::pair<Slot, Slot> range_of(const TagSpec& spec) {
  if (spec.min != 0 || spec.max != 0) return {spec.min, spec.max};
  if (is_real(spec.type)) {
    const double most = spec.type == TagType::REAL ? static_cast<double>(std::numeric_limits<float>::max())
                                                   : std::numeric_limits<double>::max();
    return {real_slot(spec.type, -most), real_slot(spec.type, most)};
  }
  const IntegerRange range = integer_range(spec.type);
  return {static_cast<Slot>(range.min), static_cast<Slot>(range.max)};
}

/// The value in the tag's encoding; nothing when it is of another kind or out of range.
std::optional<Slot> slot_of(const TagSpec& spec, const Raw& raw) {
  const auto [low, high] = range_of(spec);
  const auto* number = std::get_if<std::int64_t>(&raw);
  if (is_real(spec.type)) {
    const auto* real = std::get_if<double>(&raw);
    if (number == nullptr && real == nullptr) return std::nullopt;
    const double value = real != nullptr ? *real : static_cast<double>(*number);
    if (!(value >= real_of(spec.type, low) && value <= real_of(spec.type, high))) return std::nullopt;
    return real_slot(spec.type, value);
  }
  std::optional<std::int64_t> value;
  if (spec.type == TagType::BOOL) {
    if (const auto* flag = std::get_if<bool>(&raw)) value = *flag ? 1 : 0;
  } else if (spec.type == TagType::TIME) {
    if (const auto* text = std::get_if<std::string>(&raw)) value = parse_duration_ns(*text);
  } else if (number != nullptr) {
    value = *number;
  }
  if (!value || *value < static_cast<std::int64_t>(low) || *value > static_cast<std::int64_t>(high))
    return std::nullopt;
  return static_cast<Slot>(*value);
}

bool less(TagType type, Slot a, Slot b) {
  if (is_real(type)) return real_of(type, a) < real_of(type, b);
  return static_cast<std::int64_t>(a) < static_cast<std::int64_t>(b);
}

std::string allowed_values(const TagSpec& spec) {
  if (spec.type == TagType::BOOL) return "true or false";
  const auto [low, high] = range_of(spec);
  return value_text(spec.type, low) + " to " + value_text(spec.type, high);
}

/// One station against its program.
class StationCheck {
 public:
  StationCheck(StationConfig& station, const ProgramTags& program, Problems& problems)
      : station_(station), program_(program), problems_(problems) {}

  void run() {
    for (TagMapping& mapping : station_.inputs) check_mapping(mapping, io::Direction::input);
    for (TagMapping& mapping : station_.outputs) check_mapping(mapping, io::Direction::output);
    check_places(io::Direction::input);
    check_places(io::Direction::output);
    for (ParameterConfig& parameter : station_.parameters) check_parameter(parameter);
    for (ParameterConfig& tag : station_.tags) check_tag(tag);
  }

 private:
  const TagSpec* find(std::string_view tag) const {
    for (const TagSpec& spec : program_.tags)
      if (spec.name == tag) return &spec;
    return nullptr;
  }

  bool from_bus(std::string_view tag) const {
    return std::find(program_.bus_inputs.begin(), program_.bus_inputs.end(), tag) !=
           program_.bus_inputs.end();
  }

  template <class Wanted> std::string hint(std::string_view tag, const Wanted& wanted) const {
    std::vector<std::string_view> names;
    for (const TagSpec& spec : program_.tags)
      if (wanted(spec)) names.push_back(spec.name);
    return suggestion(tag, names);
  }

  void check_mapping(TagMapping& mapping, io::Direction direction) {
    const Area area = direction == io::Direction::input ? Area::input : Area::output;
    const std::string path = mapping_path(station_, direction, mapping.tag);
    const TagSpec* spec = find(mapping.tag);
    if (spec == nullptr) {
      problems_.add(
          mapping.position, path,
          "the program \"" + station_.program + "\" has no such tag" +
              hint(mapping.tag, [&](const TagSpec& s) { return s.area == area && !from_bus(s.name); }));
      return;
    }
    if (spec->area != area || from_bus(spec->name)) {
      const std::string what = spec->area == area ? "an input that the program takes from the bus"
                                                  : std::string(name_of(spec->area)) + " tag";
      problems_.add(mapping.position, path,
                    "found a tag that is " + what + " of the program; allowed here are " +
                        std::string(name_of(area)) + " tags that come from a device");
      return;
    }
    check_type(mapping, *spec, path);
    mapping.point.type = spec->type;
    if (direction == io::Direction::output) resolve_safe(mapping, *spec, path);
  }

  void check_type(const TagMapping& mapping, const TagSpec& spec, const std::string& path) {
    const std::string type(name_of(spec.type));
    if (mapping.type && *mapping.type != spec.type)
      problems_.add(mapping.type_position, path + ".type",
                    "found " + std::string(name_of(*mapping.type)) + "; the program declares " + type);
    else if (mapping.device.empty())
      return;
    else if (spec.type == TagType::STRING)
      problems_.add(mapping.at_position, path + ".at", "the tag is a STRING, which cannot be mapped");
    else if (io::is_bits(mapping.point.table) != (spec.type == TagType::BOOL))
      problems_.add(mapping.at_position, path + ".at",
                    "found the table " + std::string(short_name(mapping.point.table)) +
                        " for a tag of type " + type +
                        "; allowed is BOOL in co and di, numbers in ir and hr");
    else if (mapping.point.address + io::width_of(mapping.point.table, spec.type) > 65536)
      problems_.add(mapping.at_position, path + ".at",
                    "a " + type + " does not fit behind the last address, 65535");
  }

  void resolve_safe(TagMapping& mapping, const TagSpec& spec, const std::string& path) {
    mapping.point.safe_action = spec.hold ? io::SafeAction::hold : io::SafeAction::value;
    mapping.point.safe_value = spec.safe;
    if (!mapping.safe_given || std::holds_alternative<std::monostate>(mapping.safe_raw)) return;
    const auto* text = std::get_if<std::string>(&mapping.safe_raw);
    if (text != nullptr && *text == "hold") {
      mapping.point.safe_action = io::SafeAction::hold;
      return;
    }
    mapping.point.safe_action = io::SafeAction::value;
    if (const auto value = slot_of(spec, mapping.safe_raw))
      mapping.point.safe_value = *value;
    else
      problems_.add(
          mapping.safe_position, path + ".safe",
          "found " + raw_text(mapping.safe_raw) + "; allowed is \"hold\", or " + allowed_values(spec));
  }

  /// Each input and output of the program has a place.
  void check_places(io::Direction direction) {
    const bool input = direction == io::Direction::input;
    const auto& mappings = input ? station_.inputs : station_.outputs;
    std::string missing;
    for (const TagSpec& spec : program_.tags) {
      if (spec.area != (input ? Area::input : Area::output) || from_bus(spec.name)) continue;
      const bool mapped = std::any_of(mappings.begin(), mappings.end(),
                                      [&](const TagMapping& mapping) { return mapping.tag == spec.name; });
      if (!mapped) missing += (missing.empty() ? "" : ", ") + spec.name;
    }
    if (!missing.empty())
      problems_.add(station_.position, mapping_path(station_, direction, {}),
                    "without a place in a device: " + missing + "; the program \"" + station_.program +
                        "\" needs one for each");
  }

  void check_parameter(ParameterConfig& parameter) {
    const std::string path = "station." + station_.name + ".parameters." + parameter.tag;
    const TagSpec* spec = find(parameter.tag);
    if (spec == nullptr || !spec->parameter) {
      problems_.add(parameter.position, path,
                    "the program \"" + station_.program + "\" has no such parameter" +
                        hint(parameter.tag, [](const TagSpec& s) { return s.parameter; }));
      return;
    }
    if (check_own(parameter, *spec, path)) check_value(parameter, *spec, path);
  }

  /// What is to be writable beside parameters: the program's own, since inputs and outputs are forced.
  void check_tag(ParameterConfig& tag) {
    const std::string path = "station." + station_.name + ".tags." + tag.tag;
    const auto wanted = [](const TagSpec& s) {
      return !s.parameter && (s.area == Area::internal || s.area == Area::retained);
    };
    const TagSpec* spec = find(tag.tag);
    if (spec != nullptr && wanted(*spec) && spec->type != TagType::STRING) {
      check_own(tag, *spec, path);
      return;
    }
    std::string what = "the program \"" + station_.program + "\" has no such tag" + hint(tag.tag, wanted);
    if (spec != nullptr && spec->parameter)
      what = "found a parameter; it belongs into [station.parameters]";
    else if (spec != nullptr && spec->type == TagType::STRING)
      what = "the tag is a STRING, which cannot be set";
    else if (spec != nullptr)
      what = "found an " + std::string(name_of(spec->area)) +
             " tag; allowed are internal and retained tags: inputs and outputs can be forced";
    problems_.add(tag.position, path, what);
  }

  /// Type and limits; the limits narrow those of the program. False: a problem was added.
  bool check_own(ParameterConfig& tag, const TagSpec& spec, const std::string& path) {
    tag.min = spec.min;
    tag.max = spec.max;
    if (tag.type && *tag.type != spec.type) {
      problems_.add(tag.position, path + ".type",
                    "found " + std::string(name_of(*tag.type)) + "; the program declares " +
                        std::string(name_of(spec.type)));
      return false;
    }
    const bool low = !std::holds_alternative<std::monostate>(tag.raw_min);
    const bool high = !std::holds_alternative<std::monostate>(tag.raw_max);
    if (!low && !high) return true;
    if (spec.type == TagType::BOOL) {
      problems_.add(low ? tag.min_position : tag.max_position, path + (low ? ".min" : ".max"),
                    "found a limit of a BOOL, which has none");
      return false;
    }
    std::tie(tag.min, tag.max) = range_of(spec);
    if (low && !limit(tag.min, tag.raw_min, spec, tag.min_position, path + ".min")) return false;
    if (high && !limit(tag.max, tag.raw_max, spec, tag.max_position, path + ".max")) return false;
    if (less(spec.type, tag.min, tag.max)) return true;
    problems_.add(low ? tag.min_position : tag.max_position, path + (low ? ".min" : ".max"),
                  "found " + value_text(spec.type, tag.min) + " to " + value_text(spec.type, tag.max) +
                      "; the least value has to be below the greatest");
    return false;
  }

  bool limit(Slot& out, const Raw& raw, const TagSpec& spec, Position position, const std::string& path) {
    const auto value = slot_of(spec, raw);
    if (value)
      out = *value;
    else
      problems_.add(position, path, "found " + raw_text(raw) + "; allowed is " + allowed_values(spec));
    return value.has_value();
  }

  /// The file's value, or the program's own, within the limits.
  void check_value(ParameterConfig& parameter, const TagSpec& spec, const std::string& path) {
    TagSpec narrowed = spec;
    narrowed.min = parameter.min;
    narrowed.max = parameter.max;
    const bool given = !std::holds_alternative<std::monostate>(parameter.raw);
    parameter.value = spec.initial;
    if (!given && (narrowed.min != spec.min || narrowed.max != spec.max)) {
      const auto [low, high] = range_of(narrowed);
      if (less(spec.type, spec.initial, low) || less(spec.type, high, spec.initial))
        problems_.add(parameter.position, path,
                      "the program's own value, " + value_text(spec.type, spec.initial) + ", is outside of " +
                          allowed_values(narrowed) + "; give a value");
    }
    if (!given) return;
    if (const auto value = slot_of(narrowed, parameter.raw))
      parameter.value = *value;
    else
      problems_.add(parameter.value_position, path,
                    "found " + raw_text(parameter.raw) + "; allowed is " + allowed_values(narrowed) +
                        (spec.unit.empty() ? "" : " (" + spec.unit + ")"));
  }

  StationConfig& station_;
  const ProgramTags& program_;
  Problems& problems_;
};

/// A mapped stretch of one table of one device.
struct Stretch {
  std::string_view device;
  io::Table table;
  std::uint32_t first, last;
  TagType type;
  bool output;
  const TagMapping* mapping;
  std::string path;
};

std::string place_text(const Stretch& stretch) {
  return std::string(stretch.device) + ":" + std::string(short_name(stretch.table)) + ":" +
         std::to_string(stretch.first);
}

std::vector<Stretch> stretches_of(const Configuration& configuration) {
  std::vector<Stretch> all;
  for (const StationConfig& station : configuration.stations)
    for (const auto* group : {&station.inputs, &station.outputs})
      for (const TagMapping& mapping : *group) {
        if (mapping.device.empty()) continue;
        const io::Point& point = mapping.point;
        const std::uint32_t last = point.address + io::width_of(point.table, point.type) - 1U;
        all.push_back({mapping.device, point.table, point.address, last, point.type,
                       group == &station.outputs, &mapping,
                       mapping_path(station, point.direction, mapping.tag)});
      }
  return all;
}

/// Two may lie on each other if at most one drives them and both see the same value.
bool clash(const Stretch& a, const Stretch& b) {
  if (a.device != b.device || a.table != b.table || a.last < b.first || b.last < a.first) return false;
  const bool same = a.first == b.first && a.last == b.last && a.type == b.type;
  return !same || (a.output && b.output);
}

void check_heartbeats(const Configuration& configuration, const std::vector<Stretch>& all,
                      Problems& problems) {
  for (const Stretch& stretch : all) {
    const io::DeviceOptions* device = configuration.device(stretch.device);
    if (device == nullptr || device->heartbeat_period_ns == 0 || stretch.table != io::Table::holding_register)
      continue;
    const std::uint32_t at = device->heartbeat_register;
    if (!stretch.output || at < stretch.first || at > stretch.last) continue;
    problems.add(stretch.mapping->at_position, stretch.path + ".at",
                 "found a place that the heartbeat of device \"" + device->name + "\" writes, register " +
                     std::to_string(at) + "; each register has one writer");
  }
}

}  // namespace

void check_overlaps(const Configuration& configuration, Problems& problems) {
  // By table and first address, so that only neighbours have to be looked at.
  std::vector<Stretch> all = stretches_of(configuration);
  std::stable_sort(all.begin(), all.end(), [](const Stretch& a, const Stretch& b) {
    return std::tie(a.device, a.table, a.first) < std::tie(b.device, b.table, b.first);
  });
  constexpr std::uint32_t widest = 4;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      const Stretch& a = all[i];
      const Stretch& b = all[j];
      if (a.device != b.device || a.table != b.table || b.first >= a.first + widest) break;
      if (!clash(a, b)) continue;
      const Stretch& later = a.mapping->position.line > b.mapping->position.line ? a : b;
      const Stretch& earlier = &later == &a ? b : a;
      problems.add(later.mapping->at_position, later.path + ".at",
                   "found " + place_text(later) + ", which lies on " + earlier.path + " (" +
                       place_text(earlier) + ", " + std::string(name_of(earlier.type)) +
                       "); each place has one tag, and an output one writer");
    }
  check_heartbeats(configuration, all, problems);
}

void check_programs(Configuration& configuration, const ProgramCatalogue& programs, Problems& problems) {
  std::vector<std::string> told;  // a refusal that several stations share, such as that of a recipe
  for (StationConfig& station : configuration.stations) {
    if (station.program.empty()) continue;
    const std::vector<std::string_view> names(programs.names.begin(), programs.names.end());
    const std::string path = "station." + station.name;
    if (std::find(names.begin(), names.end(), station.program) == names.end()) {
      std::string all;
      for (const std::string_view name : names) all += (all.empty() ? "" : ", ") + std::string(name);
      problems.add(station.program_position, path + ".program",
                   "found \"" + station.program + "\", which there is not; there are " + all +
                       suggestion(station.program, names));
      continue;
    }
    try {
      const ProgramOptions options{station.name, station.upstream, station.downstream, configuration.recipes};
      const ProgramTags tags = programs.tags(station.program, options);
      StationCheck(station, tags, problems).run();
    } catch (const SetupError& error) {
      if (std::ranges::find(told, error.what()) != told.end()) continue;
      told.emplace_back(error.what());
      problems.add(station.program_position, path + ".program", error.what());
    }
  }
  check_overlaps(configuration, problems);
}

std::vector<Problem> check_stations(Configuration& configuration, const ProgramCatalogue& programs) {
  Problems problems(configuration.file);
  check_programs(configuration, programs, problems);
  return problems.take();
}

}  // namespace stationd::config

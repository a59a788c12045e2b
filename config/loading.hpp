// Loading: the parts of reading a controller's or supervisor's file, one function per section.
// Owned by load_controller() and load_supervisor().
// Set-up only; one thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "config/section.hpp"

namespace stationd::config {

/// Reports what stands at the top of the file beside `sections`' headings.
void report_unknown_sections(const Node& root, std::span<const SectionKeys* const> sections,
                             Problems& problems);

/// A file with `[supervisor]` and nothing of a controller; or with sections of a controller and no
/// `[supervisor]`.
enum class FileKind : std::uint8_t { controller, supervisor };
/// True, and reported as the one problem, if the file is of the other kind than `wanted`.
bool is_other_kind(const Node& root, FileKind wanted, Problems& problems);

/// `[name]`: the table, or an empty one; reported if it is something else, or missing though `required`.
const Node& single_table(const Node& root, std::string_view name, bool required, Problems& problems);
/// `[[name]]`: the tables; reported if it is something else, or missing and `required`.
std::vector<const Node*> table_list(const Node& root, std::string_view name, bool required,
                                    Problems& problems);

/// "device.NAME", or "device[2]" for the second when it has no (usable) name.
std::string path_of(std::string_view section, const Node& table, std::size_t index);

/// True, and reported, if `name` is in `taken`; else it is added.
bool is_taken(const Section& section, const std::string& name, std::vector<std::string>& taken);

void load_log(const Node& root, LogLevel& level, Problems& problems);
void load_state_dir(const Section& section, std::filesystem::path& dir);
/// Bus options; `controller` is null for a supervisor.
void load_bus(const Node& root, bus::Options& options, Configuration* controller, Problems& problems);
void load_tasks(const Node& root, Configuration& configuration, Problems& problems);
void load_devices(const Node& root, Configuration& configuration, Problems& problems);
void load_plant(const Node& root, Configuration& configuration, Problems& problems);
void load_recipes(const Node& root, Configuration& configuration, Problems& problems);
/// After tasks and devices, to which stations refer.
void load_stations(const Node& root, Configuration& configuration, Problems& problems);

/// Values of outputs and parameters as the file has them; monostate for tables, lists and dates.
RawValue raw_value(const Node& node);

/// Outputs that share a register or coil, also with a heartbeat; inputs that share a register in part.
void check_overlaps(const Configuration& configuration, Problems& problems);

/// check_stations() into a list of problems that may hold others already.
void check_programs(Configuration& configuration, const ProgramCatalogue& programs, Problems& problems);

/// "station.NAME.inputs.TAG" and so on.
std::string mapping_path(const StationConfig& station, io::Direction direction, std::string_view tag);

}  // namespace stationd::config

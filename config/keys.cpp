#include "config/keys.hpp"

#include <array>

namespace stationd::config {
namespace {

constexpr std::array kController = {
    Key{"name", "text", "", "Name of this controller on the bus: letters, digits, `-` and `_`, at most 64."},
    Key{"state_dir", "text", "`$STATE_DIRECTORY`, else `/var/lib/stationd`",
        "Folder of what outlives a restart. An absolute path."},
    Key{"require_realtime", "boolean", "`false`",
        "`true`: refuse to start when the system refuses real-time priority, memory lock or CPU; `false`: "
        "say so and "
        "go on."},
    Key{"keep_cpus_awake", "boolean", "`true`",
        "`true`: keep the CPUs out of deep sleep, from which they wake late, where a task has a real-time "
        "priority; `false`: save the power."},
    Key{"restart_on_stuck", "boolean", "`false`",
        "`true`: while a task makes no progress the service manager's watchdog is not fed, so it restarts "
        "the "
        "daemon; `false`: the stations of the other tasks go on."},
};

constexpr std::array kLog = {
    Key{"level", "`debug`, `info`, `warning` or `error`", "`info`", "The least severity that is logged."},
};

constexpr std::array kBus = {
    Key{"domain", "integer", "`0`", "DDS domain, 0 to 99. Components of one cell share it."},
    Key{"cell", "text", "`\"assembly\"`", "DDS partition: cells on one network do not see each other."},
    Key{"interfaces", "list of text", "`[\"127.0.0.1\"]`",
        "IPv4 addresses of this machine to bind to; an empty list means all of them."},
    Key{"lease", "duration", "`\"500ms\"`",
        "How long a component may be silent before the others take it as gone, 50ms to 60s."},
    Key{"deadline", "duration", "`\"500ms\"`",
        "Deadline offered for periodic variables (maximum process time), 10ms to 1h."},
    Key{"heartbeat", "duration", "`100ms`, or a quarter of `deadline` if that is less",
        "A periodic variable that does not change is repeated at least so often; at most a quarter of "
        "`deadline`."},
    Key{"stale_after", "duration", "`deadline`", "Age at which a variable of another station is STALE."},
    Key{"bad_after", "duration", "four times `stale_after`",
        "Age at which it is BAD; more than `stale_after`."},
    Key{"max_body", "size", "`\"8KiB\"`", "Longest body of a request or reply, 256B to 1MiB."},
    Key{"request_depth", "integer", "`256`", "Requests and replies kept per endpoint, 64 to 65536."},
    Key{"event_depth", "integer", "`4096`", "Events kept for readers that are slow or away, 64 to 65536."},
};

constexpr std::array kTask = {
    Key{"name", "text", "", "Name of the task, for `task` of a station and for the log."},
    Key{"period", "duration", "`\"10ms\"`", "Time from one due time to the next, 250us to 60s."},
    Key{"phase", "duration", "`\"0ms\"`", "Shift of all due times; less than the period."},
    Key{"priority", "integer", "`80`", "SCHED_FIFO priority, 1 to 95; the watchdog is above."},
    Key{"cpu", "integer", "any", "The one CPU it runs on, 0 to 1023."},
    Key{"overrun", "`skip` or `fault`", "`skip`",
        "When a scan still runs at the next due time. `skip`: go on at the next due time of the grid, count "
        "what was "
        "left out; `fault`: the task's stations go to FAULT."},
    Key{"watchdog", "duration", "ten periods, at least `100ms`",
        "Without progress for so long a station loses its output permit; at least one period, at most "
        "10min."},
    Key{"spin", "duration", "`\"0ms\"`", "Wake so much earlier and wait busily; less than the period."},
};

constexpr std::array kDevice = {
    Key{"name", "text", "", "Name of the device, for `at` of a tag and for the log."},
    Key{"kind", "`modbus`, `simulated` or `null`", "`modbus`",
        "`modbus`: Modbus/TCP; `simulated`: a unit of the plant model in this process, see `[plant]`; "
        "`null`: nothing "
        "is connected, inputs read 0 and are GOOD."},
    Key{"address", "text", "none; required for `modbus`",
        "IPv4 address and port, `\"192.168.0.10:502\"`; port 502 may be left out. Names are not resolved."},
    Key{"unit", "integer", "`1`", "Modbus unit id, or the unit of the simulated plant: 1 to 247."},
    Key{"period", "duration", "`\"10ms\"`",
        "One exchange (outputs written, inputs read) per period, 1ms to 60s."},
    Key{"timeout", "duration", "`\"200ms\"`", "Longest wait for a connection or an answer, 1ms to 10s."},
    Key{"stale_after", "duration", "five periods, at least `50ms`",
        "Age at which its inputs are STALE; at least the period."},
    Key{"bad_after", "duration", "ten times `stale_after`",
        "Age at which they are BAD; more than `stale_after`."},
    Key{"heartbeat", "table", "none",
        "A holding register written with a counter, for the device's own watchdog: "
        "`{ register = 100, period = \"100ms\" }`."},
};

constexpr std::array kDeviceHeartbeat = {
    Key{"register", "integer", "", "Holding register, 0 to 65535, counted from 0; no output's place."},
    Key{"period", "duration", "`\"100ms\"`",
        "Time between two writes; at least the device's period, at most 60s."},
};

constexpr std::array kPlant = {
    Key{"seed", "integer", "`1`", "Seed of all that is random in the model, 0 and up."},
    Key{"pallets", "integer", "`0`", "Pallets that the infeed gives, 0: without end."},
    Key{"step", "duration", "`\"1ms\"`", "Fixed time step of the model, 100us to 100ms."},
    Key{"speed", "number", "`1.0`", "Plant seconds per second, 0.01 to 1000."},
    Key{"ledger", "text", "none", "File that receives the model's account of every piece."},
};

constexpr std::array kRecipe = {
    Key{"code", "integer", "", "Code of the type of piece, as it stands on the pallet: 1 to 4294967295."},
    Key{"name", "text", "none", "What people call it."},
};

constexpr std::array kStation = {
    Key{"name", "text", "", "Name of the station on the bus; unique in the cell."},
    Key{"task", "text", "the only task",
        "The task that runs it. Stations of one task run in the order of the file."},
    Key{"program", "text", "", "The program that is the station's logic."},
    Key{"on_restart", "`stopped` or `resume`", "`stopped`",
        "After a restart of the daemon: wait for Start, or go on as before."},
    Key{"upstream", "text", "none", "The station before this one, here or on another controller."},
    Key{"downstream", "text", "none", "The station behind this one, here or on another controller."},
    Key{"inputs", "table", "none", "See `[station.inputs]`."},
    Key{"outputs", "table", "none", "See `[station.outputs]`."},
    Key{"parameters", "table", "none", "See `[station.parameters]`."},
    Key{"tags", "table", "none", "See `[station.tags]`."},
};

constexpr std::array kInput = {
    Key{"at", "text", "",
        "Place in a device, `\"DEVICE:TABLE:ADDRESS\"`. Tables: `di` discrete inputs, `co` coils, `ir` input "
        "registers, "
        "`hr` holding registers; protocol addresses, counted from 0 (40001 is `hr:0`)."},
    Key{"type", "text", "the program's",
        "Must be the type that the program declares; for the reader of the file."},
    Key{"max_age", "duration", "the device's `stale_after`", "Age at which this input is STALE."},
};

constexpr std::array kOutput = {
    Key{"at", "text", "", "Place in a device, as for inputs; table `co` or `hr`."},
    Key{"type", "text", "the program's", "Must be the type that the program declares."},
    Key{"safe", "value or `\"hold\"`", "the program's; mostly off",
        "What the output does outside RUNNING: takes that value, or keeps the one it has."},
};

constexpr std::array kParameter = {
    Key{"value", "value", "the program's",
        "Within the range that the program declares; a TIME is a duration. Required unless another key is "
        "given."},
    Key{"type", "text", "the program's", "Must be the type that the program declares."},
    Key{"min", "value", "the program's", "Least value, at a Start or a `set` too; not below the program's."},
    Key{"max", "value", "the program's", "Greatest value; not above the program's."},
    Key{"writable", "boolean", "`false`",
        "`true`: an operator may `set` it while the station runs. The value is gone at the next restart."},
};

constexpr std::array kTag = {
    Key{"writable", "boolean", "",
        "`true`: an operator may `set` it while the station runs. A retained tag keeps it over a restart."},
    Key{"type", "text", "the program's", "Must be the type that the program declares."},
    Key{"min", "value", "the type's", "Least value that may be set."},
    Key{"max", "value", "the type's", "Greatest value that may be set."},
};

constexpr std::array kSupervisor = {
    Key{"name", "text", "`\"supervisor\"`", "Name of the supervisor on the bus."},
    Key{"stations", "list of text", "", "The stations it starts, in this order."},
    Key{"state_dir", "text", "`$STATE_DIRECTORY`, else `/var/lib/stationd`",
        "Folder of what outlives a restart. An absolute path."},
    Key{"journal", "text", "`\"supervisor.journal\"`",
        "File of the received events and of what operators ordered; in `state_dir` unless absolute."},
    Key{"start_repeat", "duration", "`\"500ms\"`",
        "Start is repeated so often until the station's Status confirms it, 50ms to 60s."},
    Key{"stale_after", "duration", "`\"1s\"`",
        "A station whose Status is older counts as away, 100ms to 60s."},
};

}  // namespace

const SectionKeys kControllerKeys{"controller", "[controller]", "The controller that this file is for.",
                                  kController};
const SectionKeys kLogKeys{"log", "[log]", "What is logged.", kLog};
const SectionKeys kBusKeys{"bus", "[bus]", "The DDS data bus between the components of a cell.", kBus};
const SectionKeys kTaskKeys{"task", "[[task]]", "A periodic scan; at least one.", kTask};
const SectionKeys kDeviceKeys{"device", "[[device]]", "A field device: one connection, one unit behind it.",
                              kDevice};
const SectionKeys kDeviceHeartbeatKeys{"heartbeat", "[device.heartbeat]",
                                       "Mostly written in one line: `heartbeat = { register = 100 }`.",
                                       kDeviceHeartbeat};
const SectionKeys kPlantKeys{"plant", "[plant]", "The simulated plant, for devices of kind `simulated`.",
                             kPlant};
const SectionKeys kRecipeKeys{"recipe", "[[recipe]]",
                              "A type of piece. Besides the keys below it has the values that the programs "
                              "ask for: integers, or durations "
                              "(`press_time = \"300ms\"`).",
                              kRecipe, true};
const SectionKeys kStationKeys{"station", "[[station]]", "A station; at least one.", kStation};
const SectionKeys kInputKeys{"inputs", "[station.inputs]",
                             "One line per input tag of the program: `lid_level = \"remote-io-3:ir:3\"`, or "
                             "a table with the keys below.",
                             kInput};
const SectionKeys kOutputKeys{"outputs", "[station.outputs]",
                              "One line per output tag of the program: `conveyor = \"remote-io-3:co:0\"`, or "
                              "a table with the keys below.",
                              kOutput};
const SectionKeys kParameterKeys{"parameters", "[station.parameters]",
                                 "Parameters of the program that differ from its own defaults: `step_timeout "
                                 "= \"5s\"`, or a table with the keys "
                                 "below.",
                                 kParameter};
const SectionKeys kTagKeys{"tags", "[station.tags]",
                           "Internal and retained tags of the program that an operator may set: `pieces = { "
                           "writable = true, max = 999 }`.",
                           kTag};
const SectionKeys kSupervisorKeys{"supervisor", "[supervisor]", "The supervisor of a cell.", kSupervisor};

std::span<const SectionKeys* const> controller_sections() {
  static constexpr std::array<const SectionKeys*, 13> all = {
      &kControllerKeys, &kLogKeys,   &kBusKeys,    &kTaskKeys,      &kDeviceKeys, &kDeviceHeartbeatKeys,
      &kStationKeys,    &kInputKeys, &kOutputKeys, &kParameterKeys, &kTagKeys,    &kRecipeKeys,
      &kPlantKeys};
  return all;
}

std::span<const SectionKeys* const> supervisor_sections() {
  static constexpr std::array<const SectionKeys*, 3> all = {&kSupervisorKeys, &kLogKeys, &kBusKeys};
  return all;
}

}  // namespace stationd::config

#include "io/plant/plantsim_options.hpp"

#include <functional>
#include <stdexcept>
#include <string_view>

#include "io/plant/faults.hpp"
#include "io/plant/parse.hpp"

namespace stationd::plant {

namespace {

constexpr const char* kHelp = R"(usage: plantsim [OPTION]...
Simulates the cell (loader, robot, sealer, storage; docs/cell.md) as Modbus/TCP units 1 to 4 behind one port.

  --port N            port to listen on; 0: the kernel picks one (default 5020)
  --bind ADDRESS      IPv4 address to listen on (default 127.0.0.1); anyone who reaches it can drive the plant
  --ready-file FILE   write ADDRESS:PORT to FILE once connections are accepted
  --seed N            draws the pallets' codes (default 1)
  --pallets N         pallets that the infeed gives; 0: without end (default 0)
  --codes C,C,...     codes of the first pallets, in order; then the seed draws
  --step DURATION     time step of the model, 100us to 100ms (default 1ms)
  --speed X           plant seconds per second, up to 1000 (default 1)
  --magazine N        parts a magazine holds, places a shelf has, 1 to 60000 (default 50)
  --no-operator       nobody refills magazines and empties shelves
  --watchdog DURATION a unit to which nothing was written for so long drops its coils, all but gripper_close;
                      0s: never (default 500ms, real time)
  --inject SPEC       a fault: KIND:UNIT[.INDEX][=VALUE][@FROM][+DURATION], repeatable; INDEX is a number or a
                      name; FROM is plant time since this run began; without +DURATION it stays. Examples:
                        sensor:2.pallet_in_position=1@5s+2s  jam:1.stopper_open@10s+5s  code_wrong:3=999@0s
                        register:1.base_1_level=7  magazine_empty:2.shaft_1@3s+10s  code_unreadable:2@4s+3s
                        arm_jammed_between:3@5s  pallet_lost:2.transfer@8s  part_lost:2@6s
                        part_off_pallet:3.shaft  infeed_stops:1@20s+10s
  --ledger FILE       what really happened, as JSON, kept up to date (schema in io/plant/ledger.hpp)
  --state FILE        load the plant from FILE if it is there; save it each 200 ms and at the end
  --pieces-exit N     end when N pieces are stored
  --quiet             print nothing but errors
  --help              this text

It prints "plantsim: listening on ADDRESS:PORT" when ready. SIGTERM and SIGINT end it
(ledger and state are written first).
Exit status: 0 ended as asked, 64 bad option, 65 state file cannot be used, 69 cannot listen, 73 cannot write.
)";

constexpr std::int64_t kCountMax = 4'000'000'000;

std::vector<std::uint32_t> parse_codes(std::string_view text) {
  std::vector<std::uint32_t> codes;
  while (!text.empty()) {
    const std::size_t comma = text.find(',');
    codes.push_back(
        static_cast<std::uint32_t>(parse_integer(text.substr(0, comma), "--codes", 1, 0xFFFF'FFFF)));
    text = comma == std::string_view::npos ? std::string_view{} : text.substr(comma + 1);
  }
  return codes;
}

Fault parse_injection(std::string_view text) {
  try {
    return FaultTable::checked(parse_fault(text));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("--inject " + std::string(text) + ": " + error.what());
  }
}

std::string parse_file(std::string_view text, std::string_view name) {
  if (text.empty()) throw std::invalid_argument(std::string(name) + ": the file's name is empty");
  return std::string(text);
}

using Value = std::string_view;
struct Option {
  std::string_view name;
  std::function<void(PlantsimOptions&, Value)> set;
};

const Option kWithValue[] = {
    {"--port",
     [](auto& o, Value v) { o.port = static_cast<std::uint16_t>(parse_integer(v, "--port", 0, 65535)); }},
    {"--bind", [](auto& o, Value v) { o.bind = v; }},
    {"--ready-file", [](auto& o, Value v) { o.ready_file = parse_file(v, "--ready-file"); }},
    {"--seed",
     [](auto& o, Value v) {
       o.plant.seed = static_cast<std::uint64_t>(parse_integer(v, "--seed", 0, INT64_MAX));
     }},
    {"--pallets",
     [](auto& o, Value v) {
       o.plant.pallets = static_cast<std::uint32_t>(parse_integer(v, "--pallets", 0, kCountMax));
     }},
    {"--codes", [](auto& o, Value v) { o.plant.codes = parse_codes(v); }},
    {"--step", [](auto& o, Value v) { o.plant.step_ns = parse_duration_ns(v, "--step"); }},
    {"--speed", [](auto& o, Value v) { o.speed = parse_positive(v, "--speed", 1000); }},
    {"--magazine",
     [](auto& o, Value v) {
       o.plant.magazine_capacity = static_cast<std::uint16_t>(parse_integer(v, "--magazine", 1, 60'000));
       o.plant.shelf_capacity = o.plant.magazine_capacity;
     }},
    {"--watchdog", [](auto& o, Value v) { o.watchdog_ns = parse_duration_ns(v, "--watchdog"); }},
    {"--inject", [](auto& o, Value v) { o.faults.push_back(parse_injection(v)); }},
    {"--ledger", [](auto& o, Value v) { o.ledger_file = parse_file(v, "--ledger"); }},
    {"--state", [](auto& o, Value v) { o.state_file = parse_file(v, "--state"); }},
    {"--pieces-exit", [](auto& o, Value v) {
       o.pieces_exit = static_cast<std::uint32_t>(parse_integer(v, "--pieces-exit", 0, kCountMax));
     }}};
const Option kPlain[] = {{"--no-operator", [](auto& o, Value) { o.plant.automatic_operator = false; }},
                         {"--quiet", [](auto& o, Value) { o.quiet = true; }},
                         {"--help", [](auto& o, Value) { o.help = true; }},
                         {"-h", [](auto& o, Value) { o.help = true; }}};

const Option* find(std::span<const Option> options, std::string_view name) noexcept {
  for (const Option& option : options) {
    if (option.name == name) return &option;
  }
  return nullptr;
}

}  // namespace

const char* plantsim_help() noexcept { return kHelp; }

PlantsimOptions parse_plantsim_options(std::span<const char* const> arguments) {
  PlantsimOptions options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    std::string_view name = arguments[i];
    if (const Option* const plain = find(kPlain, name)) {
      plain->set(options, {});
      continue;
    }
    const std::size_t equals = name.starts_with("--") ? name.find('=') : std::string_view::npos;
    const Option* const option = find(kWithValue, name.substr(0, equals));
    if (option == nullptr) {
      throw std::invalid_argument("unknown option \"" + std::string(name) +
                                  "\"; plantsim --help lists what there is");
    }
    if (equals == std::string_view::npos && i + 1 == arguments.size()) {
      throw std::invalid_argument(std::string(name) + " needs a value");
    }
    option->set(options, equals == std::string_view::npos ? Value(arguments[++i]) : name.substr(equals + 1));
  }
  options.plant.watchdog_ns =
      static_cast<std::int64_t>(static_cast<double>(options.watchdog_ns) * options.speed);
  return options;
}

}  // namespace stationd::plant

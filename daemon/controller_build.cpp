// Building a controller from its configuration: stations, devices, tasks, bus; nothing runs yet.
#include <sys/eventfd.h>
#include <time.h>

#include <algorithm>
#include <utility>

#include "daemon/controller.hpp"
#include "daemon/device_points.hpp"
#include "io/modbus/modbus_backend.hpp"
#include "io/null_backend.hpp"
#include "programs/programs.hpp"
#include "scan/error.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kRetainIntervalNs = 1'000'000'000;

}  // namespace

Controller::Controller(const config::Configuration& configuration, Log& log, ProgramList programs)
    : configuration_(configuration), log_(log), programs_(std::move(programs)),
      lock_(configuration.state_dir, configuration.name), utc_offset_ns_(stationd::utc_offset_ns()) {
  lock_state_directory();
  retain_ = std::make_unique<RetainThread>(
      [this](int severity, const std::string& text) {
        log_.line(static_cast<LogSeverity>(severity), text, {{"STATIOND_EVENT", "retain"}});
      },
      kRetainIntervalNs);
  for (const config::StationConfig& s : configuration_.stations) build_station(s);
  build_devices();
  build_tasks();
  build_bus();
}

void Controller::lock_state_directory() {
  if (!lock_.error().empty())
    throw StateDirectoryError(
        "state directory " + configuration_.state_dir.string() + " cannot be written: " + lock_.error() +
        "; set [controller] state_dir or $STATE_DIRECTORY to a directory that this user may write");
  if (lock_.held_by_other())
    throw AlreadyRunning("controller \"" + configuration_.name + "\" is already running: its lock " +
                         lock_.path().string() + " is held; stop that daemon first");
}

void Controller::build_station(const config::StationConfig& s) {
  const ProgramOptions program{s.name, s.upstream, s.downstream, configuration_.recipes};
  StationOptions options;
  options.name = s.name;
  options.on_restart = s.on_restart;
  options.pv_heartbeat_ns = configuration_.pv_heartbeat_ns;
  auto station = std::make_unique<Station>(options, make_program(s.program, program, programs_));
  map_tags(*station, s);
  link_devices(*station, stations_.size());
  station->set_bus_limits(configuration_.bus_stale_after_ns, configuration_.bus_bad_after_ns);
  station->seal();
  restore(*station);
  stations_.push_back(std::move(station));
}

void Controller::map_tags(Station& station, const config::StationConfig& s) {
  Image& image = station.image();
  for (const config::TagMapping& m : s.outputs) {
    TagSpec& spec = image.spec(*image.find(m.tag));
    spec.hold = m.point.safe_action == io::SafeAction::hold;
    spec.safe = m.point.safe_value;
  }
  const auto limit = [](TagSpec& spec, const config::ParameterConfig& p) {
    spec.min = p.min;
    spec.max = p.max;
    spec.writable = p.writable;
  };
  for (const config::ParameterConfig& p : s.parameters) {
    TagSpec& spec = image.spec(*image.find(p.tag));
    spec.initial = p.value;
    limit(spec, p);
  }
  for (const config::ParameterConfig& p : s.tags) limit(image.spec(*image.find(p.tag)), p);
}

void Controller::link_devices(Station& station, std::size_t index) {
  for (const io::DeviceOptions& d : configuration_.devices) {
    const DevicePoints points(configuration_, d.name);
    for (const DeviceShare& share : points.shares()) {
      if (share.station != index) continue;
      if (share.direction == io::Direction::output)
        station.add_device_outputs(d.name, share.tags);
      else
        station.add_device_inputs(d.name, share.tags, share.stale_after_ns,
                                  std::max(d.bad_after_ns, share.stale_after_ns));
    }
  }
}

void Controller::restore(Station& station) {
  auto store = std::make_unique<RetainStore>(configuration_.state_dir, configuration_.name, station.name(),
                                             layout_hash(station.image(), station.retain().tags.tags));
  const RetainStore::Loaded loaded = store->load();
  std::uint32_t epoch = loaded.epoch + 1;
  if (!loaded.adopted.empty())
    log_.info("station " + station.name() + ": retained data taken over: " + loaded.adopted);
  if (!loaded.refused.empty()) {
    log_.warning("station " + station.name() + ": retained data refused: " + loaded.refused +
                 (loaded.record ? "; the older generation is used" : "; starting cold"));
    // Without any readable record the last epoch is unknown: a time stamp is above every count of starts.
    if (loaded.epoch == 0) epoch = static_cast<std::uint32_t>(time(nullptr));
  }
  station.set_epoch(epoch);
  if (loaded.record) station.restore(loaded.record->slots);
  std::vector<Slot> slots;
  for (const TagIndex tag : station.retain().tags.tags)
    for (std::uint32_t i = 0; i < station.image().slot_count(tag); ++i)
      slots.push_back(station.image().value(tag)[i]);
  if (!store->save(epoch, slots))
    throw StateDirectoryError("retained tags cannot be written: " + store->error());
  log_.info("station " + station.name() + ": epoch " + std::to_string(epoch) + ", " +
            (loaded.record ? "warm" : "cold") + " start");
  retain_->add(station, std::move(store));
}

std::unique_ptr<io::Backend> Controller::make_backend(const io::DeviceOptions& options,
                                                      const std::vector<io::Point>& points) {
  switch (options.kind) {
    case io::DeviceKind::modbus: return std::make_unique<io::ModbusBackend>(options, points);
    case io::DeviceKind::null: return std::make_unique<io::NullBackend>();
    case io::DeviceKind::simulated: break;
  }
  if (!plant_) plant_ = std::make_shared<io::SharedPlant>(configuration_.plant);
  return std::make_unique<io::SimulatedBackend>(plant_, options.unit, points);
}

void Controller::build_devices() {
  for (const io::DeviceOptions& d : configuration_.devices) build_device(d);
}

void Controller::build_device(const io::DeviceOptions& options) {
  const DevicePoints points(configuration_, options.name);
  std::vector<io::DeviceBinding> bindings;
  std::vector<std::size_t> inputs_used(
      stations_.size());  // a station's links stand in the order of its shares
  for (const DeviceShare& share : points.shares()) {
    Station& station = *stations_[share.station];
    io::DeviceBinding binding;
    binding.permit = &station.port().permit;
    if (share.direction == io::Direction::output) {
      binding.output_points = share.places;
      for (auto& link : station.device_outputs())
        if (link->device == options.name) binding.outputs = link.get();
    } else {
      binding.input_points = share.places;
      std::size_t n = 0;
      for (auto& link : station.device_inputs())
        if (link->source == options.name && n++ == inputs_used[share.station]) binding.inputs = link.get();
      ++inputs_used[share.station];
    }
    bindings.push_back(std::move(binding));
  }
  const auto log = [this](int severity, const std::string& text) {
    log_.line(static_cast<LogSeverity>(severity), text, {{"STATIOND_EVENT", "device"}});
  };
  devices_.push_back(std::make_unique<io::Device>(options, make_backend(options, points.all()), points.all(),
                                                  std::move(bindings), log));
}

void Controller::build_tasks() {
  for (const config::TaskConfig& t : configuration_.tasks) {
    std::vector<Station*> stations;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      if (configuration_.stations[i].task != t.name) continue;
      stations.push_back(stations_[i].get());
      names.push_back(stations_[i]->name());
    }
    if (stations.empty()) continue;
    TaskOptions options;
    options.name = t.name;
    options.period_ns = t.period_ns;
    options.phase_ns = t.phase_ns;
    options.overrun = t.overrun == config::Overrun::fault ? OverrunPolicy::fault : OverrunPolicy::skip;
    RunningTask running;
    running.rt = {t.priority, t.cpu, t.spin_ns, -1};
    running.watchdog_ns = t.watchdog_ns;
    running.report = std::make_unique<MissReport>(t.name, names);
    running.task = std::make_unique<Task>(options, std::move(stations), stopwatch_);
    statistics_.add(*running.task);
    tasks_.push_back(std::move(running));
  }
}

void Controller::build_bus() {
  bus_ = std::make_unique<bus::Bus>(configuration_.bus);
  std::vector<bus::BridgedStation> bridged;
  for (RunningTask& t : tasks_)
    for (Station* s : t.task->stations())
      bridged.push_back({s, [this, task = t.task.get()] { return figures_of(*task); },
                         [this, s](Figure f, Window w) { return statistics_.buckets(*s, f, w); }});
  bus::BridgeOptions options;
  options.controller = configuration_.name;
  const auto log = [this](int severity, const std::string& text) {
    log_.line(static_cast<LogSeverity>(severity), text, {{"STATIOND_EVENT", "bus"}});
  };
  bridge_ = std::make_unique<bus::StationBridge>(*bus_, options, std::move(bridged), log);
  for (RunningTask& t : tasks_) t.rt.wake_fd = bridge_->wake_fd();
}

bus::TaskFigures Controller::figures_of(const Task& task) {
  bus::TaskFigures figures;
  figures.period_ns = task.options().period_ns;
  const Summary lateness = statistics_.lateness(task);
  figures.lateness_p99_ns = lateness.p99_ns;
  figures.lateness_max_ns = lateness.max_ns;
  const std::lock_guard lock(realtime_mutex_);
  figures.realtime = realtime_;
  return figures;
}

}  // namespace stationd

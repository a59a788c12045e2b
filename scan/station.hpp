// Station: a program with its process image, state machine and links; what one scan does to it, phase by
// phase.
// Owned by the composer (daemon or a test); driven by its task.
// Set-up by one thread; then the scan thread alone, except port() and the links' other ends.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scan/cycle.hpp"
#include "scan/forces.hpp"
#include "scan/image.hpp"
#include "scan/links.hpp"
#include "scan/nonblocking.hpp"
#include "scan/program.hpp"

namespace stationd {

enum class OnRestart : std::uint8_t { stopped, resume };

struct StationOptions {
  std::string name;
  OnRestart on_restart = OnRestart::stopped;
  std::uint32_t epoch = 1;                     ///< one more at each start of the daemon
  std::int64_t pv_heartbeat_ns = 100'000'000;  ///< the program's PVs are repeated at least so often
  std::size_t request_capacity = 64;
  std::size_t event_capacity = 256;
};

class Station {
 public:
  /// Takes the program's tags into the image and makes a link for each of its PVs. Throws SetupError.
  Station(StationOptions options, std::unique_ptr<Program> program);
  ~Station();
  Station(const Station&) = delete;
  Station& operator=(const Station&) = delete;

  // -- Set-up, in this order: image() changes, add_..., seal(), restore() -----------------------------------
  Image& image() noexcept { return image_; }
  const Image& image() const noexcept { return image_; }
  /// Tags read from (written to) one device. Throws SetupError for an unknown tag or one of the wrong area.
  InputLink& add_device_inputs(const std::string& device, const std::vector<std::string>& tags,
                               std::int64_t stale_after_ns, std::int64_t bad_after_ns);
  OutputLink& add_device_outputs(const std::string& device, const std::vector<std::string>& tags);
  /// Limits for the bus links that the program's subscriptions made.
  void set_bus_limits(std::int64_t stale_after_ns, std::int64_t bad_after_ns);
  void seal();
  /// After seal(), before the first scan: one more than the last start's, from the retained record.
  void set_epoch(std::uint32_t epoch) noexcept { options_.epoch = epoch; }
  /// After seal(): the retained tags as they were saved, in the order of retain().tags. Makes the restart
  /// warm; with OnRestart::resume a station that was running goes on. Throws SetupError when the number of
  /// slots is another.
  void restore(std::span<const Slot> slots);

  // -- What other threads hold ------------------------------------------------------------------------------
  const std::string& name() const noexcept { return options_.name; }
  std::uint32_t epoch() const noexcept { return options_.epoch; }
  Program& program() noexcept { return *program_; }
  StationPort& port() noexcept { return port_; }
  std::vector<std::unique_ptr<InputLink>>& device_inputs() noexcept { return device_inputs_; }
  std::vector<std::unique_ptr<OutputLink>>& device_outputs() noexcept { return device_outputs_; }
  std::vector<std::unique_ptr<InputLink>>& bus_inputs() noexcept { return bus_inputs_; }
  std::vector<std::unique_ptr<PvLink>>& pvs() noexcept { return pvs_; }
  RetainLink& retain() noexcept { return *retain_; }
  ImageCopy& image_copy() noexcept { return *image_copy_; }

  // -- The phases of a scan; the scan thread ----------------------------------------------------------------
  /// Stamps the scan (numbered from 1) and takes a Stop; all later phases and their events belong to it.
  void begin(std::int64_t now_ns, std::uint64_t scan,
             std::int64_t utc_offset_ns) noexcept STATIOND_NONBLOCKING;
  void latch() noexcept STATIOND_NONBLOCKING;
  void execute() noexcept STATIOND_NONBLOCKING;
  void commit() noexcept STATIOND_NONBLOCKING;
  void publish(std::uint64_t deadline_misses) noexcept STATIOND_NONBLOCKING;
  /// Services the oldest request. False: there is none, or it has to wait: a Start while a Stop is latched
  /// (which is carried out first, with a commit of safe values in between), any that wants a reply while the
  /// replies are full.
  bool service_one() noexcept STATIOND_NONBLOCKING;
  /// Latches a fault from outside the program (overrun policy, watchdog).
  void fault(std::uint32_t code, std::int64_t detail) noexcept STATIOND_NONBLOCKING;

  StationState state() const noexcept { return state_; }
  std::uint32_t active_fault() const noexcept { return fault_; }

 private:
  friend class Cycle;
  struct Warning {
    std::uint32_t code = 0;
    std::int64_t detail = 0;
  };
  static constexpr std::size_t kMaxWarnings = 16;

  LinkTags link_tags(const std::vector<std::string>& names, Area area) const;
  LinkTags link_tags(const std::vector<PvMember>& members) const;
  void require_unsealed() const;
  void bind();
  void set_up_output(TagIndex tag);
  void take_stop() noexcept STATIOND_NONBLOCKING;
  void take_hang() noexcept STATIOND_NONBLOCKING;
  void resume() noexcept STATIOND_NONBLOCKING;
  void latch_link(InputLink& link, std::uint32_t lost_code, std::size_t index) noexcept STATIOND_NONBLOCKING;
  void run_idle(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void apply_safe_outputs() noexcept STATIOND_NONBLOCKING;
  void publish_pv(PvLink& link, std::size_t index) noexcept STATIOND_NONBLOCKING;
  void publish_retained() noexcept STATIOND_NONBLOCKING;
  void raise(std::uint32_t code, bool active, std::int64_t detail) noexcept STATIOND_NONBLOCKING;
  bool push_event(std::uint32_t code, bool active, std::int64_t detail) noexcept STATIOND_NONBLOCKING;
  void report_lost_events() noexcept STATIOND_NONBLOCKING;
  void enter(StationState state, StopCause cause) noexcept STATIOND_NONBLOCKING;
  Reply carry_out(const Request& request) noexcept STATIOND_NONBLOCKING;
  Reply start(const Request& request, Reply reply) noexcept STATIOND_NONBLOCKING;
  Reply reset(Reply reply) noexcept STATIOND_NONBLOCKING;
  Reply force(const Request& request, Reply reply) noexcept STATIOND_NONBLOCKING;
  Reply unforce(const Request& request, Reply reply) noexcept STATIOND_NONBLOCKING;
  Reply unforce_all(Reply reply) noexcept STATIOND_NONBLOCKING;
  Reply set(const Request& request, Reply reply) noexcept STATIOND_NONBLOCKING;
  void copy_image() noexcept STATIOND_NONBLOCKING;
  void set_warning(std::uint32_t code, bool active, std::int64_t detail) noexcept STATIOND_NONBLOCKING;

  StationOptions options_;
  std::unique_ptr<Program> program_;
  Image image_;
  StationPort port_;
  std::vector<std::unique_ptr<InputLink>> device_inputs_, bus_inputs_;
  std::vector<std::unique_ptr<OutputLink>> device_outputs_;
  std::vector<std::unique_ptr<PvLink>> pvs_;
  std::vector<std::vector<Slot>> pv_sent_;
  std::vector<std::int64_t> pv_sent_ns_;
  std::vector<std::uint64_t> pv_count_;
  std::vector<std::uint64_t> output_count_;
  std::unique_ptr<RetainLink> retain_;
  std::vector<Slot> retained_sent_;
  std::unique_ptr<ImageCopy> image_copy_;
  Forces forces_;
  struct SafeOutput {
    TagIndex tag = 0;
    Slot value = 0;
  };
  std::vector<SafeOutput> safe_outputs_;  // without hold
  std::vector<TagIndex> held_outputs_;
  std::vector<Slot> held_;    // their slots while idle() runs
  TagIndex running_tag_ = 0;  // retained: whether the station was running, for OnRestart::resume

  StationState state_ = StationState::STOPPED;
  StopCause cause_ = StopCause::never_started;
  Restart restart_ = Restart::cold;
  bool started_ = false;   // the next execute() is the first after Start
  bool resuming_ = false;  // RUNNING once every device was seen (OnRestart::resume)
  bool finished_ = false;  // the program reached the end of its piece while STOPPING
  bool sealed_ = false;
  std::uint32_t fault_ = 0;
  std::uint32_t pending_fault_ = 0;
  std::int64_t pending_detail_ = 0;
  std::array<Warning, kMaxWarnings> warnings_{};
  std::uint64_t events_reported_lost_ = 0;
  bool loss_told_last_ = false;  // the newest event in the ring tells of a loss
  std::uint64_t last_stop_order_ = 0;
  std::uint64_t scan_ = 0;
  std::int64_t now_ns_ = 0;
  std::int64_t utc_ns_ = 0;
  std::uint64_t retain_urgent_ = 0;
  std::uint64_t retain_scan_ = 0;
  std::uint64_t retain_count_ = 0;
  std::uint32_t step_ = 0, piece_ = 0;
  bool ready_ = false;
};

}  // namespace stationd

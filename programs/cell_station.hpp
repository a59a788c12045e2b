// CellStation: what the cell's four programs share: the track's sequence, the arm, identity of pieces,
// hand-over.
// Owned by its station; loader, robot, sealer and storage derive from it and say which parts they handle.
// Constructed in set-up; execute() and idle() run in the scan thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "programs/announcements.hpp"
#include "programs/arm.hpp"
#include "programs/piece_types.hpp"
#include "scan/cycle.hpp"
#include "scan/nonblocking.hpp"
#include "scan/program.hpp"

namespace stationd::programs {

/// The track's sequence. Every step is left by a sensor, a record or an order; none by a timer alone.
enum class Step : std::uint8_t {
  settle = 1,   ///< after Start: nothing moves until all stands where a step can begin
  wait_pallet,  ///< until a pallet stands at the entry
  admit,        ///< entry stopper opens, until the pallet is in the transfer zone
  carry_in,     ///< entry stopper closes, until the pallet is in position
  clamp,
  read,        ///< until the code is read
  identify,    ///< matched with the announcement; until its record is on disk; then Set
  wait_begin,  ///< until the upstream station's End
  work,        ///< the arm places what is missing
  press,       ///< sealer: until the lid is seated and the press time is over
  press_up,
  record_end,  ///< until "ended" is on disk; then End
  unclamp,
  wait_next,     ///< until the next station takes the pallet
  release,       ///< stopper opens, until the pallet has left
  close_stopper  ///< ... and until the record is on disk that no piece is in work
};

/// Topic Set or End as an input or output; all members come from, or go into, one sample.
struct PieceInputs {
  PieceInputs(Program& owner, const std::string& prefix, const std::string& topic);
  std::vector<PvMember> members() const;
  bool good() const noexcept { return code.good(); }
  Announcement announcement() const noexcept { return {epoch, seq, code, false}; }
  In<std::uint32_t> code;
  In<bool> error;
  In<std::uint32_t> status, epoch, seq;
};
struct PieceOutputs {
  PieceOutputs(Program& owner, const std::string& topic);
  std::vector<PvMember> members() const;
  Retained<std::uint32_t> code;
  Retained<bool> error;
  Retained<std::uint32_t> status, epoch, seq;
};

class CellStation : public Program {
 public:
  void execute(Cycle& cycle) noexcept final;
  void idle(Cycle& cycle) noexcept final;
  std::uint32_t reset_obstacle(const Cycle& cycle) noexcept final;
  std::string_view step_name(std::uint32_t step) const noexcept final;

 protected:
  struct Traits {
    std::span<const Kind> kinds;  ///< parts that the recipes must name
    bool press = false;
  };
  CellStation(const ProgramOptions& options, const Traits& traits);

  /// Constructor of a program: an input that the sequence cannot do without.
  void needs(std::initializer_list<const Handle*> inputs) { field_.insert(field_.end(), inputs); }

  // -- What each program says of its parts
  /// What is to be carried next for a piece of that type. `in_position`: it is here (sensors count); else
  /// it is announced and the first part may be fetched ahead. None: nothing (left) to do.
  virtual Errand wanted(const PieceType& type, bool in_position) const noexcept STATIOND_NONBLOCKING = 0;
  /// Something to be taken is at errand.from; the code of the warning when there is not.
  virtual bool source_ready(const Errand& errand) const noexcept STATIOND_NONBLOCKING = 0;
  virtual std::uint32_t source_warning() const noexcept STATIOND_NONBLOCKING = 0;
  virtual bool target_free(const Errand& errand) const noexcept STATIOND_NONBLOCKING = 0;
  virtual bool target_full(const Errand& errand) const noexcept STATIOND_NONBLOCKING {
    static_cast<void>(errand);
    return false;
  }
  virtual bool placed(const Errand& errand) const noexcept STATIOND_NONBLOCKING = 0;
  /// The code of what sensors and record cannot settle about the piece in position; 0: nothing. Every scan
  /// from work to release. `question`: an earlier fault's code that the operator has answered by reset and
  /// Start; else 0.
  virtual std::uint32_t contradiction(std::uint32_t question) noexcept STATIOND_NONBLOCKING = 0;
  /// First scan after Start with good inputs, before anything moves.
  virtual void derive(const PieceType* type) noexcept STATIOND_NONBLOCKING { static_cast<void>(type); }

  // -- For those hooks
  bool placing(Kind kind) const noexcept {
    return ((piece_placing_.get() >> static_cast<unsigned>(kind)) & 1U) != 0;
  }
  void set_placing(Kind kind, bool on) noexcept STATIOND_NONBLOCKING;
  bool carries(Kind kind) const noexcept { return arm_.errand().kind == kind; }

  In<bool> pallet_at_entry, pallet_in_transfer, pallet_in_position, next_entry_clear;
  In<bool> entry_stopper_is_open, entry_stopper_is_closed, stopper_is_open, stopper_is_closed;
  In<bool> clamp_is_closed, clamp_is_open, arm_is_up, arm_is_down, gripper_is_open, gripper_is_closed;
  In<bool> part_in_gripper, code_valid;
  In<std::uint32_t> pallet_code;
  In<std::uint16_t> arm_position;
  Out<bool> conveyor, entry_stopper_open, stopper_open, clamp_close, read_code, arm_enable, arm_down,
      gripper_close;
  Out<std::uint16_t> arm_target;

  Retained<bool> piece_stored;           ///< storage: the piece was put on its shelf
  Retained<std::uint32_t> piece_status;  ///< what End will say; 0: well done

 private:
  struct Press {
    explicit Press(Program& owner);
    In<bool> is_up, is_down, lid_seated;
    Out<bool> down;
  };
  struct Upstream {
    explicit Upstream(Program& owner);
    PieceInputs ready, begin;
    In<std::uint32_t> state;
  };
  struct Downstream {
    explicit Downstream(Program& owner);
    In<std::uint32_t> state;
    In<bool> ready;
  };
  struct QueueTags {
    QueueTags(Program& owner, int place);
    Retained<std::uint32_t> epoch, seq, code;
    Retained<bool> ended;
  };
  struct Pair {
    const In<bool>* one;
    const In<bool>* other;
  };

  // cell_station.cpp: the scan as a whole
  void begin(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  bool inputs_usable(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  bool switches_agree(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void derive_all(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void run_arm(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  ArmInputs arm_inputs() const noexcept STATIOND_NONBLOCKING;
  ArmPermits arm_permits(const Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  Errand errand_now(const Cycle& cycle) const noexcept STATIOND_NONBLOCKING;
  void record_for_arm(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void drive() noexcept STATIOND_NONBLOCKING;
  void report(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void fail(Cycle& cycle, std::uint32_t code, std::int64_t detail = 0) noexcept STATIOND_NONBLOCKING;

  // cell_track.cpp: the steps
  void run_track(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void go(Step step) noexcept STATIOND_NONBLOCKING;
  bool late(std::int64_t more_ns = 0) const noexcept STATIOND_NONBLOCKING;
  void run_settle(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void run_wait_pallet(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void watch_arrival(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void run_arrival(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void run_clamp_and_read(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void run_identify(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void run_wait_begin(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void run_work(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void run_press(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void run_end(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void run_wait_next(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void run_release(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  bool next_takes() const noexcept STATIOND_NONBLOCKING;
  bool names_later(const PieceInputs& other) const noexcept STATIOND_NONBLOCKING;

  // cell_identity.cpp: which piece this is, and what the neighbours are told
  void load(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void hear(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void store_queue(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  std::uint32_t visible() const noexcept STATIOND_NONBLOCKING;
  void resolve_lost_pallets(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void identify(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void identify_known(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void identify_new(Cycle& cycle) noexcept STATIOND_NONBLOCKING;
  void take_on(Cycle& cycle, const Announcement& from) noexcept STATIOND_NONBLOCKING;
  void publish_piece() noexcept STATIOND_NONBLOCKING;
  void forget_piece() noexcept STATIOND_NONBLOCKING;
  const PieceType* piece_type() const noexcept { return types_.find(piece_code_); }

  PieceTypes types_;
  const bool carries_pieces_;
  std::optional<Press> press_;
  std::optional<Upstream> upstream_;
  std::optional<Downstream> downstream_;
  Param<Time> step_timeout_, arrival_timeout_, blocked_after_;
  Retained<std::uint32_t> piece_code_, piece_epoch_, piece_seq_, piece_from_epoch_, piece_from_seq_;
  Retained<bool> piece_begun_, piece_ended_;
  Retained<std::uint32_t> piece_placing_, number_epoch_, number_seq_;
  Retained<std::uint8_t> grip_kind_, grip_variant_;
  std::array<QueueTags, Announcements::kMax> queue_tags_;
  Retained<std::uint32_t> queue_size_, queue_last_epoch_, queue_last_seq_, queue_last_code_;
  PieceOutputs set_, end_;
  Var<std::uint32_t> track_step_tag_, arm_step_tag_;
  std::vector<const Handle*> field_;
  std::vector<Pair> pairs_;

  Arm arm_;
  Announcements queue_;
  Step step_ = Step::settle;
  Record recorded_for_ = Record::none;
  bool loaded_ = false;   // retained queue taken over, identity published again
  bool derived_ = false;  // since Start, in the first scan with good inputs
  bool paused_ = true;    // the last scan's inputs were not usable
  bool failed_ = false;   // a fault was raised in this scan
  bool gap_heard_ = false;
  std::uint32_t asked_ = 0;     // code of the last fault of ours
  std::uint32_t answered_ = 0;  // ... that the operator has reset and started over
  std::uint32_t answered_code_ = 0;
  std::uint32_t asked_code_ = 0;  // pallet code at the fault
  std::int64_t last_ns_ = 0;
  std::int64_t started_ns_ = 0;
  std::int64_t clock_ns_ = 0;  // runs while the inputs are usable: time-outs do not count a device's absence
  std::int64_t entered_ns_ = 0;         // into the step
  std::int64_t arrival_ns_ = 0;         // since when a pallet is awaited
  std::int64_t waits_at_entry_ns_ = 0;  // since when a pallet stands at the entry, not admitted
  std::int64_t pressed_ns_ = 0;         // since when the press is down
  std::int64_t conflict_ns_ = 0;        // since when two opposite end switches are on
  bool conflict_ = false;
  std::uint64_t record_ticket_ = 0, arm_ticket_ = 0, queue_ticket_ = 0;
};

}  // namespace stationd::programs

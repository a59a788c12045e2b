#include "scan/codes.hpp"

#include <algorithm>
#include <array>

namespace stationd {
namespace {

using enum Severity;

constexpr auto table = std::to_array<CodeInfo>({
    {code::overrun, fault, "scan overran",
     "A scan was still running at its next due time and the task's policy is `fault`.",
     "Look for what took the time in the log; lengthen the period or set overrun = \"skip\"; then reset."},
    {code::device_lost, warning, "field device lost", "A field device does not answer; its inputs are BAD.",
     "Check the device's power and cable; it is taken up again by itself."},
    {code::remote_lost, warning, "remote station lost",
     "No sample came from another station within its limit.",
     "Check the other station's daemon and the network; it is taken up again by itself."},
    {code::retained_refused, warning, "retained data refused",
     "The retained file was damaged or of another layout; it was kept aside.",
     "The station started cold: check what stands on its track before Start."},
    {code::retained_not_written, warning, "retained data not written",
     "The retained file could not be written.", "Check free space and rights of the state directory."},
    {code::realtime_refused, warning, "real-time rights refused",
     "SCHED_FIFO, memory locking or affinity was refused.",
     "Run as the service does (systemd unit), or grant CAP_SYS_NICE and CAP_IPC_LOCK."},
    {code::events_lost, warning, "events lost",
     "The event ring was full; the gap in SEQ shows how many are missing.",
     "Look for a flood of events from one cause."},
    {code::watchdog, fault, "scan made no progress",
     "The station's scan did not finish within its watchdog time.",
     "Its outputs were made safe. Find the program's loop; then reset, then Start."},
    {code::order_refused, info, "order refused",
     "An order contradicted its topic or named something unknown.", "Correct the order."},
    {code::not_in_fault, info, "nothing to reset", "`reset` was ordered while no fault was active.",
     "None needed."},
    {code::still_in_fault, info, "fault still present", "`reset` was ordered while the cause still stands.",
     "Remove the cause, then reset again."},
    {code::start_in_wrong_state, info, "Start not possible", "Start is accepted in STOPPED only.",
     "In FAULT: remove the cause, reset, then Start."},
    {code::start_overtaken, info, "Start overtaken by Stop",
     "A Stop arrived after this Start and before it was carried out.", "Send Start again if it is wanted."},
    {code::unknown_tag, info, "unknown tag", "The station has no tag of that name.",
     "See `params` and the configuration."},
    {code::unknown_verb, info, "unknown verb", "The request's first word is not a verb of the station.",
     "Use status, describe, get, reset or params."},
    {code::body_invalid, info, "request body invalid",
     "The body is too long, not UTF-8 or not of the form that the order takes.", "Correct the request."},
    {code::busy, info, "busy", "The station's request queue is full.", "Ask again later, less often."},
    {code::value_invalid, info, "value not allowed", "A value is not of its tag's type or out of its range.",
     "See `params` for the range."},
    {code::permit_revoked, info, "output permit revoked", "The watchdog took the station's output permit.",
     "Stop, then Start."},
    // -- programs: actuators and sensors
    {code::inputs_lost, fault, "field inputs lost",
     "Inputs that the sequence needs are BAD: their device does not answer.",
     "Bring the device back (power, cable), then reset and Start; the station goes on from its sensors."},
    {code::record_not_saved, fault, "record not saved",
     "A record that must be on disk before the next action was not written in time.",
     "Check free space and rights of the state directory; then reset and Start."},
    {code::step_timeout, fault, "step took too long", "A step did not end within step_timeout.",
     "Look at the station's step and what it waits for; then reset and Start."},
    {code::entry_stopper_jammed, fault, "entry stopper jammed",
     "The entry stopper did not reach its end switch in time.",
     "Free the stopper or replace its end switch; then reset and Start."},
    {code::stopper_jammed, fault, "stopper jammed", "The stopper did not reach its end switch in time.",
     "Free the stopper or replace its end switch; then reset and Start."},
    {code::clamp_jammed, fault, "clamp jammed", "The clamp did not reach its end switch in time.",
     "Free the clamp or replace its end switch; then reset and Start."},
    {code::press_jammed, fault, "press jammed", "The press did not reach its end switch in time.",
     "Free the press or replace its end switch; then reset and Start."},
    {code::arm_height_jammed, fault, "arm does not go up or down",
     "The arm did not reach its upper or lower end switch in time.",
     "Free the arm or replace its end switch; then reset and Start."},
    {code::arm_sideways_jammed, fault, "arm does not reach its position",
     "The arm did not reach arm_target in time.",
     "Free the arm or check its position sensor; then reset and Start."},
    {code::gripper_jammed, fault, "gripper jammed", "The gripper did not reach its end switch in time.",
     "Free the gripper or replace its end switch; then reset and Start."},
    {code::end_switches_conflict, fault, "end switches contradict",
     "Two opposite end switches are on (detail: 1 entry stopper, 2 stopper, 3 clamp, 4 arm, 5 gripper, 6 "
     "press).",
     "Replace the one that is stuck; then reset and Start."},
    {code::arm_astray, fault, "arm moved by itself", "The arm's position changed while it was lowered.",
     "Check the arm and its position sensor; then reset and Start."},
    {code::press_no_seat, fault, "lid not seated",
     "The press is down, its time is over, and the lid is not reported as seated.",
     "Check the lid and the seat sensor; reset and Start press once more."},
    // -- programs: pallets
    {code::pallet_stuck_at_entry, fault, "pallet stuck at the entry",
     "The entry stopper is open, and the pallet does not move on.",
     "Check the belt and free the pallet; then reset and Start."},
    {code::pallet_stuck_in_transfer, fault, "pallet stuck in the transfer zone",
     "The pallet did not reach the work position in time.",
     "Check the belt and free the pallet; then reset and Start."},
    {code::pallet_stuck_in_position, fault, "pallet does not leave",
     "The stopper is open, and the pallet does not leave the work position.",
     "Check the belt and free the pallet; then reset and Start."},
    {code::pallet_removed, fault, "pallet removed",
     "The pallet in position was taken out by hand, or its sensor failed.",
     "Is the pallet really gone? If not, put it back or repair the sensor first. Reset and Start give up "
     "the piece if no pallet is seen then."},
    {code::pallet_vanished, fault, "pallet vanished",
     "A pallet left the entry or the transfer zone and did not arrive.",
     "Was it taken out? If not, put it back or free it first. Reset and Start give it up if no pallet is "
     "seen then."},
    {code::transfer_occupied, fault, "second pallet behind the first",
     "A pallet stands in the transfer zone while another is in position; both would leave together.",
     "Take the pallet out of the transfer zone; then reset and Start."},
    {code::pallet_missing, fault, "announced pallet does not come",
     "The upstream station has let a pallet go that did not arrive within arrival_timeout.",
     "Is it still between the stations? If so, free it. After reset and Start it is awaited once more, "
     "then given up."},
    {code::code_unreadable, fault, "code not readable",
     "The code reader found no code on the pallet in position.",
     "Clean the reader and the code, or take the pallet out; then reset and Start."},
    {code::code_unknown, fault, "code unknown", "No recipe has the code of the pallet (detail).",
     "Take the pallet out, or add a recipe and restart; then reset and Start."},
    // -- programs: parts
    {code::magazine_empty, warning, "magazine empty",
     "No part is left (detail: kind x 10 + variant; kinds 1 base, 2 bearing, 3 shaft, 4 lid).",
     "Fill the magazine; the station goes on by itself."},
    {code::shelf_full, warning, "shelf full or piece not there",
     "No place is left on the shelf (detail: 50 + shelf).",
     "Empty the shelf; the station goes on by itself."},
    {code::pick_failed, fault, "nothing gripped",
     "The gripper closed and holds nothing, though the magazine is not empty.",
     "Check magazine, gripper and its sensor; reset and Start try again."},
    {code::part_lost, fault, "part lost",
     "A part that the gripper held, or that lay on the pallet, is gone (detail: kind x 10 + variant).",
     "Where is the part? Take it away; if it lies on its seat, repair the sensor first. Reset and Start "
     "place a new one if none is seen."},
    {code::place_failed, fault, "part not placed",
     "The gripper opened, and the part is not seen at its place, or still in the gripper.",
     "Is the part on its seat? If so, repair the sensor; else take it away. Reset and Start place a new "
     "one if none is seen."},
    {code::gripper_unknown_part, fault, "gripper holds an unknown part",
     "The gripper holds something of which there is no record.",
     "What is it? Take it out of the gripper; then reset and Start."},
    {code::gripper_wrong_part, fault, "gripper holds a wrong part",
     "The gripper holds a part that the piece in position does not take next.",
     "Why did the piece change? Take the part out of the gripper; then reset and Start."},
    {code::unexpected_part, fault, "part without a record",
     "A part is on the pallet that this station did not place.",
     "Is it the right part for the pallet's code? If not, take it off. Reset and Start go on with what is "
     "there."},
    {code::piece_lost, fault, "piece lost",
     "The piece is neither on the pallet nor in the gripper, and was not stored.",
     "Where is the piece? Put it back on the pallet if it is good. Reset and Start give it up if it is not "
     "there."},
    {code::place_taken, fault, "place taken",
     "The part or piece cannot be put down: its place is taken or not ready.",
     "Clear the place or repair its sensor; then reset and Start."},
    {code::next_not_ready, warning, "next station does not take the pallet",
     "The next station is not RUNNING and ready, or its entry is not clear, for longer than blocked_after.",
     "See the next station; this one goes on by itself."},
    {code::no_pallet, warning, "no pallet comes", "No pallet came for longer than blocked_after.",
     "See the upstream station or the infeed; this one goes on by itself."},
    // -- programs: identity and hand-over
    {code::announcement_gap, fault, "announcement missed",
     "The upstream station's Set skipped a SEQ: at least one announcement was never heard.",
     "Do the pallets between the stations belong to the cell? Reset and Start go on; a pallet that is "
     "unknown will be asked about."},
    {code::code_mismatch, fault, "code does not match",
     "The pallet's code (detail) is not the one announced.",
     "Does the code belong to this pallet? If not, take it out. Reset and Start accept it if the same code "
     "is read again."},
    {code::pallet_unannounced, fault, "pallet not announced",
     "A pallet came of which the upstream station said nothing; its code is the detail.",
     "Does it belong here, with all earlier parts on it? If not, take it out. Reset and Start accept it."},
    {code::piece_swapped, fault, "another pallet in position",
     "The pallet in position has another code (detail) than the piece that was in work.",
     "Was the pallet exchanged? If not, put the old one back. Reset and Start give up the old piece and "
     "accept this one."},
    {code::begin_missing, fault, "End of the upstream station missing",
     "The pallet came, but not the upstream station's End for it.",
     "Did the upstream station finish the piece? If not, take it out. Reset and Start work on it."},
    {code::begin_error, fault, "upstream station reported an error",
     "The upstream station's End says that it could not finish this piece (detail: its STATUS).",
     "Is the piece good all the same? If not, take it out. Reset and Start work on it."},
    {code::announcement_dropped, info, "announcement dropped",
     "An announced pallet was given up (detail: SEQ).", "None needed."},
    {code::piece_given_up, info, "piece given up", "The piece in work was given up; its End says so.",
     "None needed."},
    // -- the example program
    {code::example_inputs_lost, fault, "level switches lost", "A level switch is not readable.",
     "Check the device; then reset and Start."},
    {code::example_fill_timeout, fault, "tank does not fill",
     "The pump ran for fill_timeout, and the upper mark was not reached.",
     "Check pump, inlet and the upper level switch; then reset and Start."},
});

static_assert(std::ranges::is_sorted(table, {}, &CodeInfo::code));

}  // namespace

std::span<const CodeInfo> all_codes() noexcept { return table; }

const CodeInfo* find_code(std::uint32_t wanted) noexcept {
  const auto it = std::ranges::lower_bound(table, wanted, {}, &CodeInfo::code);
  return it != table.end() && it->code == wanted ? &*it : nullptr;
}

}  // namespace stationd

#include "scan/codes.hpp"

#include <algorithm>
#include <array>

namespace stationd {
namespace {

using enum Severity;

constexpr auto table = std::to_array<CodeInfo>({
    {code::overrun, fault, "scan overran", "A scan was still running at its next due time and the task's policy is `fault`.",
     "Look for what took the time in the log; lengthen the period or set overrun = \"skip\"; then reset."},
    {code::device_lost, warning, "field device lost", "A field device does not answer; its inputs are BAD.",
     "Check the device's power and cable; it is taken up again by itself."},
    {code::remote_lost, warning, "remote station lost", "No sample came from another station within its limit.",
     "Check the other station's daemon and the network; it is taken up again by itself."},
    {code::retained_refused, warning, "retained data refused", "The retained file was damaged or of another layout; it was kept aside.",
     "The station started cold: check what stands on its track before Start."},
    {code::retained_not_written, warning, "retained data not written", "The retained file could not be written.",
     "Check free space and rights of the state directory."},
    {code::realtime_refused, warning, "real-time rights refused", "SCHED_FIFO, memory locking or affinity was refused.",
     "Run as the service does (systemd unit), or grant CAP_SYS_NICE and CAP_IPC_LOCK."},
    {code::events_lost, warning, "events lost", "The event ring was full; the gap in SEQ shows how many are missing.",
     "Look for a flood of events from one cause."},
    {code::watchdog, fault, "scan made no progress", "The station's scan did not finish within its watchdog time.",
     "Its outputs were made safe. Find the program's loop; then Stop, then Start."},
    {code::order_refused, info, "order refused", "An order contradicted its topic or named something unknown.", "Correct the order."},
    {code::not_in_fault, info, "nothing to reset", "`reset` was ordered while no fault was active.", "None needed."},
    {code::still_in_fault, info, "fault still present", "`reset` was ordered while the cause still stands.",
     "Remove the cause, then reset again."},
    {code::start_in_wrong_state, info, "Start not possible", "Start is accepted in STOPPED only.",
     "In FAULT: remove the cause, reset, then Start."},
    {code::start_overtaken, info, "Start overtaken by Stop", "A Stop arrived after this Start and before it was carried out.",
     "Send Start again if it is wanted."},
    {code::unknown_tag, info, "unknown tag", "The station has no tag of that name.", "See `params` and the configuration."},
    {code::unknown_verb, info, "unknown verb", "The request's first word is not a verb of the station.",
     "Use status, describe, get, reset or params."},
    {code::body_invalid, info, "request body invalid", "The body is too long, not UTF-8 or not of the form that the order takes.",
     "Correct the request."},
    {code::busy, info, "busy", "The station's request queue is full.", "Ask again later, less often."},
    {code::value_invalid, info, "value not allowed", "A value is not of its tag's type or out of its range.",
     "See `params` for the range."},
    {code::permit_revoked, info, "output permit revoked", "The watchdog took the station's output permit.", "Stop, then Start."},
});

static_assert(std::ranges::is_sorted(table, {}, &CodeInfo::code));

}  // namespace

std::span<const CodeInfo> all_codes() noexcept { return table; }

const CodeInfo* find_code(std::uint32_t wanted) noexcept {
  const auto it = std::ranges::lower_bound(table, wanted, {}, &CodeInfo::code);
  return it != table.end() && it->code == wanted ? &*it : nullptr;
}

}  // namespace stationd

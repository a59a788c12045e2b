// The phases of a station's scan: latch, execute, commit, publish. Scan thread; nothing here allocates or
// blocks.
#include <algorithm>
#include <cstring>

#include "scan/codes.hpp"
#include "scan/station.hpp"

namespace stationd {
namespace {

Quality judge(const BlockHeader& header, const InputLink& link, std::int64_t now_ns) noexcept {
  if (header.count == 0) return Quality::BAD;
  const std::int64_t age_ns = now_ns - header.time_ns;
  if (age_ns > link.bad_after_ns) return Quality::BAD;
  if (age_ns > link.stale_after_ns) return std::min(header.quality, Quality::STALE);
  return header.quality;
}

/// Copies a link's tags from the image into a block, in order.
void gather(const Image& image, const LinkTags& tags, BlockView block) noexcept {
  Slot* out = block.slots().data();
  Quality* quality = block.qualities().data();
  for (const TagIndex tag : tags.tags) {
    const Slot* value = image.value(tag);
    const std::uint32_t n = image.slot_count(tag);
    for (std::uint32_t i = 0; i < n; ++i) *out++ = value[i];
    *quality++ = *image.quality(tag);
  }
}

}  // namespace

void Station::begin(std::int64_t now_ns, std::uint64_t scan, std::int64_t utc_offset_ns) noexcept {
  now_ns_ = now_ns;
  utc_ns_ = now_ns + utc_offset_ns;
  scan_ = scan;
  take_stop();
  take_hang();
}

/// The watchdog took the permit while the scan hung, and raised the event: what the I/O threads made safe
/// stays safe until an operator acts.
void Station::take_hang() noexcept {
  if (port_.hung.load(std::memory_order_relaxed)) {
    port_.hung.store(false, std::memory_order_relaxed);
    if (state_ == StationState::FAULT) return raise(code::watchdog, false, 0);
    enter(StationState::FAULT, StopCause::after_fault);
    fault_ = code::watchdog;
  }
  if (driven(state_) && !port_.permit.load(std::memory_order_acquire)) fault(code::watchdog, 0);
}

void Station::take_stop() noexcept {
  const StopLatch::Taken stop = port_.stop.take();
  if (stop.mode == StopMode::none) return;
  last_stop_order_ = std::max(last_stop_order_, stop.order);
  resuming_ = false;
  if (!driven(state_)) {
    if (state_ == StationState::STOPPED) cause_ = StopCause::ordered;
    return;
  }
  if (stop.mode == StopMode::immediate)
    enter(StationState::STOPPED, StopCause::ordered);
  else
    enter(StationState::STOPPING, StopCause::ordered);
}

void Station::latch_link(InputLink& link, std::uint32_t lost_code, std::size_t index) noexcept {
  const bool fresh = link.blocks.update();
  const ConstBlockView block{link.blocks.readable(), link.tags.layout};
  // What a source sends along with BAD is no value: the last one stays, and its quality tells.
  const bool take = fresh && block.header().quality != Quality::BAD;
  const Quality source = judge(block.header(), link, now_ns_);
  const Slot* in = block.slots().data();
  const Quality* quality = block.qualities().data();
  for (const TagIndex tag : link.tags.tags) {
    const std::uint32_t n = image_.slot_count(tag);
    if (take) {
      Slot* value = image_.value(tag);
      for (std::uint32_t i = 0; i < n; ++i) value[i] = in[i];  // mostly one: no call is worth it
    }
    in += n;
    *image_.quality(tag) = std::min(source, *quality++);
  }
  const bool lost = link.seen && source == Quality::BAD;
  if (source == Quality::GOOD) link.seen = true;
  if (lost == link.lost) return;
  link.lost = lost;
  raise(lost_code, lost, static_cast<std::int64_t>(index));
}

void Station::latch() noexcept {
  forces_.lift_inputs(image_);
  for (std::size_t i = 0; i < device_inputs_.size(); ++i)
    latch_link(*device_inputs_[i], code::device_lost, i);
  for (std::size_t i = 0; i < bus_inputs_.size(); ++i) latch_link(*bus_inputs_[i], code::remote_lost, i);
  forces_.apply_inputs(image_);
}

/// What idle() does to the outputs is undone: those without hold by the commit, those with it here.
void Station::run_idle(Cycle& cycle) noexcept {
  Slot* kept = held_.data();
  for (const TagIndex tag : held_outputs_)
    kept = std::copy_n(image_.value(tag), image_.slot_count(tag), kept);
  program_->idle(cycle);
  const Slot* back = held_.data();
  for (const TagIndex tag : held_outputs_) {
    const std::uint32_t n = image_.slot_count(tag);
    std::copy_n(back, n, image_.value(tag));
    back += n;
  }
}

/// A program that goes on by itself would fault on devices that have not answered yet: it waits for each of
/// them.
void Station::resume() noexcept {
  const auto seen = [](const auto& link) { return link->seen; };
  if (!resuming_ || !std::all_of(device_inputs_.begin(), device_inputs_.end(), seen)) return;
  resuming_ = false;
  if (state_ == StationState::STOPPED) enter(StationState::RUNNING, StopCause::never_started);
}

void Station::execute() noexcept {
  resume();
  port_.executing.store(true, std::memory_order_relaxed);
  Cycle cycle(*this, now_ns_);
  forces_.lift_outputs(image_, driven(state_));
  if (driven(state_)) {
    program_->execute(cycle);
    started_ = false;
    if (finished_ && state_ == StationState::STOPPING) enter(StationState::STOPPED, StopCause::ordered);
  } else {
    run_idle(cycle);
    ready_ = false;
  }
  port_.executing.store(false, std::memory_order_relaxed);
  if (pending_fault_ != 0) {
    const std::uint32_t code = pending_fault_;
    pending_fault_ = 0;
    fault(code, pending_detail_);
  }
}

void Station::apply_safe_outputs() noexcept {
  if (driven(state_)) return;
  for (const SafeOutput& output : safe_outputs_) *image_.value(output.tag) = output.value;
}

void Station::commit() noexcept {
  forces_.apply_outputs(image_, driven(state_));
  apply_safe_outputs();
  for (std::size_t i = 0; i < device_outputs_.size(); ++i) {
    OutputLink& link = *device_outputs_[i];
    const BlockView block{link.blocks.writable(), link.tags.layout};
    gather(image_, link.tags, block);
    block.header() = {now_ns_, utc_ns_, scan_, ++output_count_[i], Quality::GOOD};
    link.blocks.publish();
  }
}

void Station::publish_pv(PvLink& link, std::size_t index) noexcept {
  const BlockView block{link.blocks.writable(), link.tags.layout};
  gather(image_, link.tags, block);
  std::vector<Slot>& sent = pv_sent_[index];
  const bool changed = !std::equal(sent.begin(), sent.end(), block.slots().begin());
  if (!changed && pv_count_[index] != 0 && now_ns_ - pv_sent_ns_[index] < link.heartbeat_ns) return;
  std::copy(block.slots().begin(), block.slots().end(), sent.begin());
  pv_sent_ns_[index] = now_ns_;
  block.header() = {now_ns_, utc_ns_, scan_, ++pv_count_[index], Quality::GOOD};
  if (link.blocks.publish()) link.overtaken.fetch_add(1, std::memory_order_relaxed);
}

void Station::publish_retained() noexcept {
  const BlockView block{retain_->blocks.writable(), retain_->tags.layout};
  gather(image_, retain_->tags, block);
  const bool changed = !std::equal(retained_sent_.begin(), retained_sent_.end(), block.slots().begin());
  if (!changed && retain_urgent_ <= retain_scan_) return;
  std::copy(block.slots().begin(), block.slots().end(), retained_sent_.begin());
  retain_scan_ = scan_;
  block.header() = {now_ns_, utc_ns_, scan_, ++retain_count_, Quality::GOOD};
  retain_->blocks.publish();
  if (retain_urgent_ == scan_) retain_->urgent_scan.store(scan_, std::memory_order_release);
}

void Station::copy_image() noexcept {
  const BlockView block{image_copy_->blocks.writable(), image_copy_->tags.layout};
  gather(image_, image_copy_->tags, block);
  block.header() = {now_ns_, utc_ns_, scan_, 1, Quality::GOOD};
  image_copy_->blocks.publish();
}

void Station::publish(std::uint64_t deadline_misses) noexcept {
  for (std::size_t i = 0; i < pvs_.size(); ++i) publish_pv(*pvs_[i], i);
  publish_retained();
  report_lost_events();
  StatusRecord status;
  status.state = state_;
  status.cause = cause_;
  status.ready = ready_ && state_ == StationState::RUNNING;
  status.epoch = options_.epoch;
  status.fault = fault_;
  for (const Warning& w : warnings_)
    if (w.code != 0) status.warning = w.code;
  status.step = step_;
  status.piece = piece_;
  status.forced = static_cast<std::uint32_t>(forces_.standing());
  status.scan = scan_;
  status.deadline_misses = deadline_misses;
  status.time_ns = now_ns_;
  status.utc_ns = utc_ns_;
  port_.status.publish(status);
  port_.progress.store(scan_, std::memory_order_release);
}

}  // namespace stationd

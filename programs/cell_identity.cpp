// Which piece stands in position, what the upstream station announced, what the neighbours are told. Scan
// thread.
#include "programs/cell_station.hpp"
#include "scan/codes.hpp"

namespace stationd::programs {

/// First scan of the process: what was retained is on disk, so the neighbours may hear it (again).
void CellStation::load(Cycle& cycle) noexcept {
  if (loaded_) return;
  loaded_ = true;
  if (cycle.restart() == Restart::cold) return;
  Announcements::Content content;
  content.size = queue_size_;
  content.last_epoch = queue_last_epoch_;
  content.last_seq = queue_last_seq_;
  content.last_code = queue_last_code_;
  for (std::size_t i = 0; i < Announcements::kMax; ++i) {
    const QueueTags& tags = queue_tags_[i];
    content.entries[i] = {tags.epoch, tags.seq, tags.code, tags.ended};
  }
  queue_.restore(content);
  publish_piece();
}

void CellStation::store_queue(Cycle& cycle) noexcept {
  const Announcements::Content& content = queue_.content();
  queue_size_ = content.size;
  queue_last_epoch_ = content.last_epoch;
  queue_last_seq_ = content.last_seq;
  queue_last_code_ = content.last_code;
  for (std::size_t i = 0; i < Announcements::kMax; ++i) {
    const Announcement& entry = content.entries[i];
    QueueTags& tags = queue_tags_[i];
    tags.epoch = entry.epoch;
    tags.seq = entry.seq;
    tags.code = entry.code;
    tags.ended = entry.ended;
  }
  queue_ticket_ = cycle.save_retained();
}

/// Pallets that stand in this station's zones and have not been matched with an announcement.
std::uint32_t CellStation::visible() const noexcept {
  return (pallet_at_entry ? 1U : 0U) + (pallet_in_transfer ? 1U : 0U) +
         (pallet_in_position && piece_code_ == 0 ? 1U : 0U);
}

void CellStation::hear(Cycle& cycle) noexcept {
  if (!upstream_) return;
  const Announcements::Content before = queue_.content();
  if (upstream_->ready.good()) {
    switch (queue_.hear_set(upstream_->ready.announcement(), visible())) {
      case Announcements::Heard::gap: gap_heard_ = true; break;
      case Announcements::Heard::overflow: cycle.note(code::announcement_dropped); break;
      default: break;
    }
  }
  if (upstream_->begin.good() && upstream_->begin.code != 0)
    queue_.hear_end(upstream_->begin.announcement(), upstream_->begin.error);
  if (!(before == queue_.content())) store_queue(cycle);
}

/// After Start: is what was in work, or on its way, still here?
void CellStation::resolve_lost_pallets(Cycle& cycle) noexcept {
  if (piece_code_ != 0 && !pallet_in_position) {
    if (!piece_ended_ && !piece_stored) {
      if (answered_ != code::pallet_removed) return fail(cycle, code::pallet_removed, piece_code_);
      piece_status = code::pallet_removed;
      cycle.note(code::piece_given_up, piece_code_);
    }
    piece_ended_ = true;
    publish_piece();
    forget_piece();
  } else if ((answered_ == code::pallet_removed || answered_ == code::pallet_vanished) &&
             queue_.ended_count() > visible()) {
    cycle.note(code::announcement_dropped, queue_.front()->seq);
    queue_.pop_front();
    store_queue(cycle);
  }
}

void CellStation::identify(Cycle& cycle) noexcept {
  if (types_.find(pallet_code) == nullptr) return fail(cycle, code::code_unknown, pallet_code);
  if (piece_code_ != 0)
    identify_known(cycle);
  else
    identify_new(cycle);
}

/// A piece was in work here before the last Start.
void CellStation::identify_known(Cycle& cycle) noexcept {
  if (pallet_code == piece_code_) {
    // What a doubt or a fallen part left open is done again; the End that follows has the same number.
    if (piece_ended_ && piece_status == 0 && !wanted(*piece_type(), true).none()) piece_ended_ = false;
    return;
  }
  if (answered_ != code::piece_swapped || answered_code_ != pallet_code)
    return fail(cycle, code::piece_swapped, pallet_code);
  if (!piece_ended_) {
    piece_status = code::piece_swapped;
    piece_ended_ = true;
    cycle.note(code::piece_given_up, piece_code_);
    publish_piece();
  }
  forget_piece();
  take_on(cycle, {});
}

void CellStation::identify_new(Cycle& cycle) noexcept {
  if (!upstream_) return take_on(cycle, {});
  const Announcement* front = queue_.front();
  if (front != nullptr && front->code == pallet_code) {
    const Announcement from = *front;
    queue_.pop_front();
    return take_on(cycle, from);
  }
  const bool answered = (answered_ == code::code_mismatch || answered_ == code::pallet_unannounced) &&
                        answered_code_ == pallet_code;
  if (!answered)
    return fail(cycle, front != nullptr ? code::code_mismatch : code::pallet_unannounced, pallet_code);
  const Announcement* match = queue_.skip_to(pallet_code);
  const Announcement from = match != nullptr ? *match : Announcement{};
  if (match != nullptr) queue_.pop_front();
  take_on(cycle, from);
}

/// Gives the pallet in position its number. `from`: its announcement; without a number where the operator
/// vouched for it or there is no upstream station.
void CellStation::take_on(Cycle& cycle, const Announcement& from) noexcept {
  number_seq_ = number_epoch_ == cycle.epoch() ? number_seq_ + 1 : 1;
  number_epoch_ = cycle.epoch();
  piece_code_ = pallet_code;
  piece_epoch_ = number_epoch_;
  piece_seq_ = number_seq_;
  piece_from_epoch_ = from.epoch;
  piece_from_seq_ = from.seq;
  piece_begun_ = from.code == 0 || from.ended;
  store_queue(cycle);
  record_ticket_ = queue_ticket_;
}

/// Set, and End once the piece has ended, as the record has them. Only for what is on disk: a number must
/// not be given twice.
void CellStation::publish_piece() noexcept {
  if (piece_code_ == 0) return;
  set_.code = piece_code_;
  set_.epoch = piece_epoch_;
  set_.seq = piece_seq_;
  if (!piece_ended_) return;
  end_.code = piece_code_;
  end_.error = piece_status != 0;
  end_.status = piece_status;
  end_.epoch = piece_epoch_;
  end_.seq = piece_seq_;
}

void CellStation::forget_piece() noexcept {
  piece_code_ = 0;
  piece_epoch_ = 0;
  piece_seq_ = 0;
  piece_from_epoch_ = 0;
  piece_from_seq_ = 0;
  piece_begun_ = false;
  piece_ended_ = false;
  piece_stored = false;
  piece_status = 0;
  piece_placing_ = 0;
}

}  // namespace stationd::programs

#include "programs/announcements.hpp"

namespace stationd::programs {

void Announcements::remove(std::uint32_t index) noexcept {
  if (index >= content_.size) return;
  for (std::uint32_t i = index; i + 1 < content_.size; ++i) content_.entries[i] = content_.entries[i + 1];
  content_.entries[--content_.size] = {};
}

Announcements::Heard Announcements::hear_set(const Announcement& set, std::uint32_t visible) noexcept {
  if (set.code == 0) return Heard::nothing;
  const bool numbered = set.epoch != 0 || set.seq != 0;
  const bool same_epoch = set.epoch == content_.last_epoch;
  if (same_epoch && set.seq == content_.last_seq && (numbered || set.code == content_.last_code))
    return Heard::nothing;
  const bool gap = numbered && same_epoch && set.seq != content_.last_seq + 1;
  if (!same_epoch) drop_void(visible, set.code);
  content_.last_epoch = set.epoch;
  content_.last_seq = set.seq;
  content_.last_code = set.code;
  const bool overflow = content_.size == kMax;
  if (overflow) pop_front();
  content_.entries[content_.size++] = {set.epoch, set.seq, set.code, false};
  return gap ? Heard::gap : overflow ? Heard::overflow : Heard::queued;
}

void Announcements::drop_void(std::uint32_t visible, std::uint32_t code) noexcept {
  if (content_.size == 0 || content_.size <= visible) return;
  const Announcement& newest = content_.entries[content_.size - 1];
  if (!newest.ended && newest.code == code) remove(content_.size - 1);
}

void Announcements::hear_end(const Announcement& end, bool error) noexcept {
  const bool numbered = end.epoch != 0 || end.seq != 0;
  for (std::uint32_t i = 0; i < content_.size; ++i) {
    Announcement& entry = content_.entries[i];
    const bool named = entry.epoch == end.epoch && entry.seq == end.seq && entry.code == end.code;
    if (named && error) return remove(i);
    if (named || (numbered && entry.epoch == end.epoch && entry.seq < end.seq)) entry.ended = true;
  }
}

const Announcement* Announcements::skip_to(std::uint32_t code) noexcept {
  for (std::uint32_t i = 0; i < content_.size; ++i) {
    if (content_.entries[i].code != code) continue;
    for (; i > 0; --i) pop_front();
    return front();
  }
  return nullptr;
}

std::uint32_t Announcements::ended_count() const noexcept {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < content_.size; ++i)
    if (content_.entries[i].ended) ++count;
  return count;
}

void Announcements::restore(const Content& content) noexcept {
  content_ = content.size <= kMax ? content : Content{};
}

}  // namespace stationd::programs

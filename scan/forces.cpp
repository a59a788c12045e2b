#include "scan/forces.hpp"

namespace stationd {

bool forceable(const TagSpec& spec) noexcept {
  return (spec.area == Area::input || spec.area == Area::output) && spec.type != TagType::STRING;
}

Forces::Force* Forces::find(TagIndex tag) noexcept {
  for (std::size_t i = 0; i < count_; ++i)
    if (forces_[i].tag == tag) return &forces_[i];
  return nullptr;
}

void Forces::drop(std::size_t at) noexcept { forces_[at] = forces_[--count_]; }

Forces::Taken Forces::force(TagIndex tag, Slot value, bool output) noexcept {
  Force* old = find(tag);
  if (old != nullptr && !old->released) {
    const bool same = old->value == value;
    old->value = value;
    return same ? Taken::unchanged : Taken::changed;
  }
  if (standing_ == kMost || (old == nullptr && count_ == forces_.size())) return Taken::full;
  ++standing_;
  if (old == nullptr) {
    forces_[count_] = {};
    old = &forces_[count_++];
  }
  old->tag = tag;
  old->value = value;
  old->output = output;
  old->released = false;
  return Taken::changed;
}

bool Forces::release(TagIndex tag) noexcept {
  Force* force = find(tag);
  if (force == nullptr || force->released) return false;
  --standing_;
  force->released = true;
  if (!force->applied) drop(static_cast<std::size_t>(force - forces_.data()));
  return true;
}

TagIndex Forces::release_any() noexcept {
  std::size_t at = 0;
  while (forces_[at].released) ++at;
  const TagIndex tag = forces_[at].tag;
  release(tag);
  return tag;
}

void Forces::apply(Image& image, Force& force) noexcept {
  force.own = *image.value(force.tag);
  force.own_quality = *image.quality(force.tag);
  force.committed = force.value;
  force.applied = true;
  *image.value(force.tag) = force.value;
  *image.quality(force.tag) = Quality::FORCED;
}

void Forces::lift_inputs(Image& image) noexcept {
  for (std::size_t i = count_; i-- > 0;) {
    Force& force = forces_[i];
    if (force.output) continue;
    if (force.applied) {
      *image.value(force.tag) = force.own;
      *image.quality(force.tag) = force.own_quality;
    }
    force.applied = false;
    if (force.released) drop(i);
  }
}

void Forces::apply_inputs(Image& image) noexcept {
  for (std::size_t i = 0; i < count_; ++i)
    if (!forces_[i].output) apply(image, forces_[i]);
}

void Forces::lift_outputs(Image& image, bool driven) noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    Force& force = forces_[i];
    if (!force.output || !force.applied) continue;
    if (driven) *image.value(force.tag) = force.own;
    *image.quality(force.tag) = force.own_quality;
  }
}

void Forces::apply_outputs(Image& image, bool driven) noexcept {
  for (std::size_t i = count_; i-- > 0;) {
    Force& force = forces_[i];
    if (!force.output) continue;
    const bool was_applied = force.applied;
    force.applied = false;
    // The permit fell within this scan: the device has what was committed before, and hold keeps that.
    if (!driven && was_applied) *image.value(force.tag) = force.committed;
    if (force.released)
      drop(i);
    else if (driven)
      apply(image, force);
  }
}

}  // namespace stationd

#include "scan/image.hpp"

#include <algorithm>

#include "scan/error.hpp"

namespace stationd {
namespace {

bool well_formed(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
  });
}

}  // namespace

TagIndex Image::add(TagSpec spec) {
  if (!well_formed(spec.name))
    throw SetupError("tag name \"" + spec.name + "\": letters, digits, '_' and '.' are allowed");
  const auto index = static_cast<TagIndex>(specs_.size());
  if (!by_name_.emplace(spec.name, index).second)
    throw SetupError("tag \"" + spec.name + "\" is declared twice");
  specs_.push_back(std::move(spec));
  return index;
}

std::uint32_t Image::slot_count(TagIndex tag) const {
  const TagSpec& s = specs_[tag];
  return s.type == TagType::STRING ? 1U + (s.length + 7U) / 8U : 1U;
}

void Image::seal() {
  std::uint32_t next = 0;
  for (TagIndex tag = 0; tag < specs_.size(); ++tag) {
    first_slot_.push_back(next);
    next += slot_count(tag);
  }
  slots_.assign(next, 0);
  qualities_.assign(specs_.size(), Quality::GOOD);
  for (TagIndex tag = 0; tag < specs_.size(); ++tag) {
    *value(tag) = specs_[tag].initial;
    if (specs_[tag].area == Area::input) *quality(tag) = Quality::BAD;
  }
}

std::optional<TagIndex> Image::find(std::string_view name) const {
  const auto it = by_name_.find(std::string(name));
  if (it == by_name_.end()) return std::nullopt;
  return it->second;
}

}  // namespace stationd

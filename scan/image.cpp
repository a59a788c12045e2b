#include "scan/image.hpp"

#include <algorithm>

#include "scan/error.hpp"

namespace stationd {
namespace {

constexpr std::uint16_t kMaxStringLength = 255;

bool well_formed(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
  });
}

}  // namespace

TagIndex Image::add(TagSpec spec) {
  if (!well_formed(spec.name))
    throw SetupError("tag name \"" + spec.name + "\": letters, digits, '_' and '.' are allowed");
  if (sealed()) throw SetupError("tag \"" + spec.name + "\" comes after the image was sealed");
  if (spec.type == TagType::STRING && (spec.length < 1 || spec.length > kMaxStringLength))
    throw SetupError("tag \"" + spec.name + "\": a STRING holds 1 to 255 bytes, not " +
                     std::to_string(spec.length));
  const auto index = static_cast<TagIndex>(specs_.size());
  if (!by_name_.emplace(spec.name, index).second)
    throw SetupError("tag \"" + spec.name + "\" is declared twice");
  specs_.push_back(std::move(spec));
  return index;
}

std::uint32_t Image::slots_of(const TagSpec& spec) noexcept {
  return spec.type == TagType::STRING ? 1U + (spec.length + 7U) / 8U : 1U;
}

void Image::seal() {
  std::vector<std::uint32_t> firsts;
  std::uint32_t next = 0;
  for (const TagSpec& spec : specs_) {
    firsts.push_back(next);
    next += slots_of(spec);
  }
  firsts.push_back(next);
  first_slot_ = std::move(firsts);
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

#include "dds_bridge/topic_type.hpp"

#include <cstddef>
#include <span>
#include <string>

namespace stationd::bus {

TopicType::TopicType(const TypeTable& table) : table_(table) {
  define(std::string(table.name).c_str(), table.usual_size(), table.keyed());
}

bool TopicType::encode(const void* data, compat::rtps::SerializedPayload_t& payload) noexcept {
  const PayloadUse use(payload);
  const std::span<std::byte> out(reinterpret_cast<std::byte*>(payload.data), payload.max_size);
  payload.length = bus::encode(table_, static_cast<const Sample*>(data)->object, out);
  payload.encapsulation = CDR_LE;
  return payload.length != 0;
}

bool TopicType::decode(const compat::rtps::SerializedPayload_t& payload, void* data) noexcept {
  auto& sample = *static_cast<Sample*>(data);
  const PayloadUse use(payload);
  const std::span<const std::byte> in(reinterpret_cast<const std::byte*>(payload.data), payload.length);
  sample.valid = bus::decode(table_, in, sample.object);
  return true;
}

/// A malformed sample must not fail here either: Fast DDS 2.9 would put it into its history without an
/// instance, and abort when it is taken. All of them share one instance that no key can have, and are dropped
/// when taken.
bool TopicType::key(const void* data, compat::rtps::InstanceHandle_t& handle, bool force_md5) noexcept {
  const auto& sample = *static_cast<const Sample*>(data);
  KeyHash hash;
  if (!sample.valid)
    hash.fill(0xFF);
  else if (!key_hash(table_, sample.object, force_md5, hash))
    return false;  // only our own writers get here
  for (std::size_t i = 0; i < hash.size(); ++i) handle.value[i] = hash[i];
  return true;
}

std::uint32_t TopicType::encoded_size(const void* data) noexcept {
  const std::uint32_t size = bus::encoded_size(table_, static_cast<const Sample*>(data)->object);
  return size == 0 ? table_.usual_size() : size;  // 0: too long; encode() refuses it
}

void* TopicType::create() { return new Sample{table_.make(), true}; }

void TopicType::destroy(void* data) noexcept {
  auto* sample = static_cast<Sample*>(data);
  table_.drop(sample->object);
  delete sample;
}

}  // namespace stationd::bus

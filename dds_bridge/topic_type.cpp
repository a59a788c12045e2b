#include "dds_bridge/topic_type.hpp"

#include <cstddef>
#include <span>
#include <string>

namespace stationd::bus {

TopicType::TopicType(const TypeTable& table, std::atomic<std::uint64_t>& malformed)
    : table_(table), malformed_(malformed) {
  define(std::string(table.name).c_str(), table.usual_size(), table.keyed());
}

bool TopicType::encode(const void* data, compat::rtps::SerializedPayload_t& payload) noexcept {
  const std::span<std::byte> out(reinterpret_cast<std::byte*>(payload.data), payload.max_size);
  payload.length = bus::encode(table_, static_cast<const Sample*>(data)->object, out);
  payload.encapsulation = CDR_LE;
  return payload.length != 0;
}

bool TopicType::decode(const compat::rtps::SerializedPayload_t& payload, void* data) noexcept {
  auto& sample = *static_cast<Sample*>(data);
  const std::span<const std::byte> in(reinterpret_cast<const std::byte*>(payload.data), payload.length);
  sample.valid = bus::decode(table_, in, sample.object);
  return true;
}

bool TopicType::key(const void* data, compat::rtps::InstanceHandle_t& handle, bool force_md5) noexcept {
  const auto& sample = *static_cast<const Sample*>(data);
  KeyHash hash;
  if (!sample.valid || !key_hash(table_, sample.object, force_md5, hash)) {
    if (!sample.valid) malformed_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
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

// TopicType: a member table as a type that Fast DDS can register.
// Private to dds_bridge; owned by the participant that it is registered with.
// Called from the library's threads as well as ours; has no state.
#pragma once

#include <cstdint>

#include "dds_bridge/compat.hpp"
#include "dds_bridge/type_table.hpp"

#if defined(__SANITIZE_THREAD__)
#define STATIOND_UNDER_TSAN
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define STATIOND_UNDER_TSAN
#endif
#endif
#ifdef STATIOND_UNDER_TSAN
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace stationd::bus {

/// Marks the use of a payload's buffer. The library's pool hands buffers on under a lock of its own, from
/// readers to writers of other participants too; ThreadSanitizer does not see that lock: the library is not
/// instrumented.
class PayloadUse {
 public:
  explicit PayloadUse(const compat::rtps::SerializedPayload_t& payload) noexcept : data_(payload.data) {
#ifdef STATIOND_UNDER_TSAN
    __tsan_acquire(data_);
#endif
  }
  // NOLINTNEXTLINE(modernize-use-equals-default): it is not trivial under ThreadSanitizer
  ~PayloadUse() {
#ifdef STATIOND_UNDER_TSAN
    __tsan_release(data_);
#endif
  }
  PayloadUse(const PayloadUse&) = delete;
  PayloadUse& operator=(const PayloadUse&) = delete;

 private:
  [[maybe_unused]] void* data_;
};

/// What Fast DDS sees as a sample. Decoding never fails towards the library: a malformed sample arrives as
/// one with `valid` false and is dropped and counted by whoever takes it.
struct Sample {
  void* object = nullptr;
  bool valid = true;
};

class TopicType final : public compat::Type {
 public:
  explicit TopicType(const TypeTable& table);

  const TypeTable& table() const noexcept { return table_; }

  bool encode(const void* data, compat::rtps::SerializedPayload_t& payload) noexcept override;
  bool decode(const compat::rtps::SerializedPayload_t& payload, void* data) noexcept override;
  bool key(const void* data, compat::rtps::InstanceHandle_t& handle, bool force_md5) noexcept override;
  std::uint32_t encoded_size(const void* data) noexcept override;
  void* create() override;
  void destroy(void* data) noexcept override;

 private:
  const TypeTable& table_;
};

}  // namespace stationd::bus

#include "scan/snapshot.hpp"

namespace stationd {

Snapshot::Snapshot(std::size_t size_bytes)
    : size_bytes_(size_bytes), stride_((size_bytes + kAlign - 1) / kAlign * kAlign + kAlign),
      storage_(new std::byte[stride_ * 3 + kAlign]()),
      base_(storage_.get() + (kAlign - reinterpret_cast<std::uintptr_t>(storage_.get()) % kAlign) % kAlign) {}

}  // namespace stationd

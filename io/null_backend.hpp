// NullBackend: a device that is not there: reads 0, takes all outputs. For trying a program without a field.
// Owned by its device thread.
// The device thread only.
#pragma once

#include <algorithm>

#include "io/backend.hpp"

namespace stationd::io {

class NullBackend final : public Backend {
 public:
  ExchangeResult exchange(std::span<const OutputValue>, std::span<Slot> inputs, std::int64_t) override {
    std::fill(inputs.begin(), inputs.end(), 0);
    return {};
  }
  void close() noexcept override {}
};

}  // namespace stationd::io

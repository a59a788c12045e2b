// Throttle: log lines of one kind at most once a second; the next one says how many it stands for.
// Owned by the bridge.
// Any plain thread; a mutex inside.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>

namespace stationd::bus {

class Throttle {
 public:
  using Sink = std::function<void(int severity, const std::string& text)>;
  explicit Throttle(Sink sink) : sink_(std::move(sink)) {}

  /// `kind`: one of a small set of names. `now_ns`: CLOCK_MONOTONIC.
  void say(const std::string& kind, int severity, const std::string& text, std::int64_t now_ns);
  /// What may never be held back: each change that an operator makes.
  void say_each(int severity, const std::string& text) const {
    if (sink_) sink_(severity, text);
  }
  /// Says what was held back for a second; to be called now and then.
  void flush(std::int64_t now_ns);

 private:
  struct Held {
    std::int64_t said_ns = 0;
    std::uint64_t count = 0;
    int severity = 0;
    std::string text;
  };
  static constexpr std::int64_t kPeriod = 1'000'000'000;

  Sink sink_;
  std::mutex mutex_;
  std::map<std::string, Held> kinds_;
};

}  // namespace stationd::bus

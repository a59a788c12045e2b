// Support of the bus tests: options on loopback, waiting for conditions, collecting what arrives.
// Owned by each test.
// The test's thread, and the bus-in thread where it says so.
#pragma once

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "dds_bridge/bus.hpp"

namespace stationd::bus::test {

/// The domain that the test run has claimed, else one derived from the process, 1..99.
inline int domain() {
  const char* claimed = std::getenv("STATIOND_TEST_DOMAIN");
  return claimed != nullptr ? std::atoi(claimed) : 1 + static_cast<int>(getpid() % 99);
}

inline Options options(const std::string& name) {
  Options options;
  options.domain = domain();
  options.name = name;
  options.cell = "test-" + std::to_string(getpid());
  return options;
}

/// True as soon as the condition holds; the limit is generous because machines are slow, and no test waits
/// for it.
inline bool eventually(const std::function<bool()>& condition,
                       std::chrono::seconds limit = std::chrono::seconds(30)) {
  const auto until = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

/// What handlers collect (bus-in thread) and tests look at.
template <class T> class Inbox {
 public:
  void put(const T& item) {
    const std::lock_guard lock(mutex_);
    items_.push_back(item);
  }
  std::vector<T> all() const {
    const std::lock_guard lock(mutex_);
    return items_;
  }
  std::size_t size() const { return all().size(); }
  bool wait_for(std::size_t count) const {
    return eventually([&] { return size() >= count; });
  }
  bool any(const std::function<bool(const T&)>& condition) const {
    for (const T& item : all()) {
      if (condition(item)) return true;
    }
    return false;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<T> items_;
};

}  // namespace stationd::bus::test

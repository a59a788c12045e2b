// Supervisor: asks the cell's supervisor which stations there should be.
// Owned by a command.
// The command's thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ctl/client.hpp"

namespace stationd::ctl {

/// A station that the supervisor knows and that is not on the bus.
struct Missing {
  std::string station;
  std::string controller;               ///< that ran it last; empty: the supervisor never saw it
  std::optional<std::int64_t> seen_ns;  ///< its last Status, CLOCK_MONOTONIC; none: it never came
};

/// What the supervisor's answer to `status` says of stations that are away.
std::vector<Missing> missing_of(std::string_view answer, std::int64_t now_ns);

class SupervisorQuestion {
 public:
  explicit SupervisorQuestion(Client& client) : client_(client), id_(client.new_id()) {}
  /// Call it often while waiting for stations: asks, again and again until the answer is there.
  void ask();
  bool answered() const { return answered_; }
  /// Those that are not among `stations`; none without an answer.
  std::vector<Missing> missing(const Stations& stations) const;

 private:
  Client& client_;
  const std::string id_;
  std::int64_t asked_ns_ = 0;
  bool answered_ = false;
  std::vector<Missing> away_;
};

}  // namespace stationd::ctl

// SetupError: what set-up throws when it is asked for something that cannot be; never thrown while running.
// Owned by nobody; caught at the edge of start-up, where it becomes a message and an exit status.
// Set-up threads only.
#pragma once

#include <stdexcept>
#include <string>

namespace stationd {

class SetupError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stationd

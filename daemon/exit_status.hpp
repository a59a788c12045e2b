// Exit statuses of stationd and of its companions, after sysexits.h; what a script or systemd tells failures
// apart by.
// Owned by nobody (constants).
// Any thread.
#pragma once

namespace stationd {

enum ExitStatus : int {
  kExitOk = 0,
  kExitFailure = 1,        ///< something went wrong while running; the log says what
  kExitUsage = 64,         ///< command line
  kExitUnavailable = 69,   ///< no DDS network, another daemon has the station's name or the controller's lock
  kExitOsError = 71,       ///< no thread, no memory
  kExitCannotCreate = 73,  ///< the state directory cannot be written
  kExitNoPermission = 77,  ///< require_realtime = true and rights were refused
  kExitConfig = 78         ///< the configuration has errors
};

}  // namespace stationd

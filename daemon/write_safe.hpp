// `stationd --write-safe FILE`: writes every output's safe value to its device once; what ExecStopPost= runs.
// Owned by nobody (a function).
// The main thread of a process of its own.
#pragma once

#include "config/config.hpp"

namespace stationd {

/// Says for each Modbus device what happened; outputs with safe = "hold" are left alone. Nothing is written
/// while a daemon of
/// the same controller runs, or (as ExecStopPost=) after a daemon that gave way to another ($EXIT_STATUS is
/// 69). The
/// result is an exit status: failure when a device could not be written within two seconds.
int write_safe_outputs(const config::Configuration& configuration);

}  // namespace stationd

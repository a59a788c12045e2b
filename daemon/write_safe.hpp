// `stationd --write-safe FILE`: writes every output's safe value to its device once; what ExecStopPost= runs.
// Owned by nobody (a function).
// The main thread of a process of its own.
#pragma once

#include "config/config.hpp"

namespace stationd {

/// Says for each Modbus device what happened; outputs with safe = "hold" are left alone. The result is an
/// exit status: failure when
/// a device could not be written.
int write_safe_outputs(const config::Configuration& configuration);

}  // namespace stationd

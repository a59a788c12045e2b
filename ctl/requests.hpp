// Requests: asks a station (RR) and waits for its answer.
// Owned by nobody; the client is the command's.
// The command's thread.
#pragma once

#include <optional>
#include <string>

#include "ctl/client.hpp"

namespace stationd::ctl {

/// The answer of arguments.station, or nothing within the time-out. What does no harm twice is repeated.
std::optional<bus::MsgRes> ask(Client& client, const Arguments& arguments, const std::string& text);

}  // namespace stationd::ctl

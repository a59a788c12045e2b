// Requests: asks a station (RR) and waits for its answer.
// Owned by nobody; the client is the command's.
// The command's thread.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "ctl/client.hpp"

namespace stationd::ctl {

/// The answer of arguments.station, or nothing within the time-out. What does no harm twice is repeated.
std::optional<bus::MsgRes> ask(Client& client, const Arguments& arguments, const std::string& text);

/// What a station answered, as a line for people.
using Say = std::function<std::string(const std::string& body)>;

/// Prints the answer (with --json as one object), or says why it was refused. `say` may be empty: as it is.
int show(const Arguments& arguments, const bus::MsgRes& reply, const Say& say);
/// Says that none came.
int fail_unanswered(const Arguments& arguments, Client& client);
int ask_and_show(const Arguments& arguments, const std::string& text, const Say& say = {});

}  // namespace stationd::ctl

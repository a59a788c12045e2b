// Answers: what the supervisor says to a Msg_Req addressed to it (RR; Calvo et al. 2013, section 4.2).
// Owned by nobody (pure functions over the model).
// The model's thread.
#pragma once

#include <cstdint>
#include <string>

#include "dds_bridge/messages.hpp"
#include "supervisor/model.hpp"

namespace stationd::supervisor {

/// The reply to `request`. An unknown verb, station or code: ERROR, with STATUS saying why (scan/codes.hpp).
/// BODY begins with the `id=N` of the request, if it had one; DEST_STATION is its `from=`.
bus::MsgRes answer(const Model& model, const bus::MsgReq& request, std::int64_t now_ns);

}  // namespace stationd::supervisor

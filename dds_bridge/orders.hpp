// Orders: Start, Stop and Msg_Req for the bridge's stations: checked here, carried out by the scan.
// Private to dds_bridge; owned by the bridge.
// The bus-in thread.
#pragma once

#include <cstdint>
#include <string>

#include "dds_bridge/bridge_context.hpp"

namespace stationd::bus {

class Orders {
 public:
  explicit Orders(Context& context) : context_(context) {}

  /// Never queued: sets the station's latch. Body: `mode=immediate` (default) or `mode=end_of_piece`.
  void on_stop(const MsgReq& order, const Origin& origin);
  /// Body: `parameter=value` pairs, all checked before the scan gets them. Full ring: counted and logged.
  void on_start(const MsgReq& order, const Origin& origin);
  /// Body: a verb: status, describe CODE, reset, params, histogram FIGURE, or one of tag_orders.hpp.
  /// Every one is answered.
  void on_request(const MsgReq& request, const Origin& origin);

 private:
  struct Answer {
    std::string text;
    std::uint32_t refusal = 0;  ///< code; 0: answered
    std::uint32_t code = 0;     ///< what it is about
    bool later = false;         ///< the scan has it; bus-out replies
  };

  void refuse(const char* what, const MsgReq& order, const Body& body, std::uint32_t code,
              const std::string& why);
  Answer answer(BridgedEntry& entry, const Body& body, const Origin& origin);
  Answer to_scan(BridgedEntry& entry, const Body& body, const Origin& origin, Request request);
  static Answer status(BridgedEntry& entry);
  static Answer describe(const Body& body);
  static Answer params(BridgedEntry& entry);
  Answer histogram(BridgedEntry& entry, const Body& body) const;

  Context& context_;
};

}  // namespace stationd::bus

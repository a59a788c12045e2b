#include "dds_bridge/bridge_context.hpp"

#include <algorithm>
#include <utility>

#include "scan/codes.hpp"

namespace stationd::bus {

std::string code_with_name(std::uint32_t code) {
  const CodeInfo* info = find_code(code);
  return code_id(code) + (info == nullptr ? "" : " (" + std::string(info->name) + ")");
}

void PendingTable::add(Pending pending, Request& request) {
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= kMost) waiting_.erase(waiting_.begin());
  request.token = ++last_;
  pending.request = request;
  waiting_.emplace(request.token, std::move(pending));
}

std::optional<Pending> PendingTable::take(std::uint64_t token) {
  const std::lock_guard lock(mutex_);
  auto node = waiting_.extract(token);
  if (node.empty()) return std::nullopt;
  return std::move(node.mapped());
}

BridgedEntry* Context::find(const std::string& station) noexcept {
  const auto it =
      std::ranges::find_if(stations, [&](const auto& e) { return e->station->name() == station; });
  return it == stations.end() ? nullptr : it->get();
}

void Context::reply(const Body& body, const Origin& origin, std::uint32_t code, std::uint32_t refusal,
                    const std::string& text) {
  MsgRes reply;
  reply.DEST_STATION = body.from;
  reply.CODE = code;
  reply.ERROR = refusal != 0;
  reply.STATUS = refusal;
  reply.BODY = clipped(reply_prefix(body) + text, bus.options().max_body_bytes);
  if (!bus.write_reply(reply, origin)) counters.replies_lost.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace stationd::bus

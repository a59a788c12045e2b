#include "ctl/supervisor.hpp"

#include <algorithm>

#include "config/units.hpp"
#include "ctl/replies.hpp"
#include "scan/clock.hpp"

namespace stationd::ctl {
namespace {

/// The name that a supervisor has unless its file gives another.
constexpr const char* kName = "supervisor";
constexpr std::int64_t kRepeat_ns = 200'000'000;

}  // namespace

std::vector<Missing> missing_of(std::string_view answer, std::int64_t now_ns) {
  std::vector<Missing> out;
  for (const Pairs& line : pairs_of(answer)) {
    const std::string* station = find_value(line, "station");
    const std::string* state = find_value(line, "state");
    if (station == nullptr || state == nullptr || *state != "away") continue;
    Missing& missing = out.emplace_back();
    missing.station = *station;
    if (const std::string* controller = find_value(line, "controller")) missing.controller = *controller;
    const std::string* age = find_value(line, "age");
    if (const auto age_ns = age == nullptr ? std::nullopt : config::parse_duration_ns(*age))
      missing.seen_ns = now_ns - *age_ns;
    const std::string* configured = find_value(line, "configured");
    const bool expected = configured == nullptr || *configured == "true";
    if (!expected && !missing.seen_ns) out.pop_back();  // counted once, long ago
  }
  return out;
}

void SupervisorQuestion::ask() {
  if (answered_) return;
  const std::int64_t now_ns = monotonic_ns();
  std::string body;
  const auto replied = [&] {
    const bus::MsgRes* reply = client_.reply_to(id_);
    if (reply != nullptr && !reply->ERROR) body = without_id(reply->BODY);
    return reply != nullptr;
  };
  if (client_.wait(now_ns, replied)) {
    answered_ = true;
    away_ = missing_of(body, now_ns);
  } else if (asked_ns_ == 0 || now_ns - asked_ns_ >= kRepeat_ns) {
    asked_ns_ = now_ns;
    client_.bus().write_request({kName, client_.addressed("status", id_), bus::Order::MSG});
  }
}

std::vector<Missing> SupervisorQuestion::missing(const Stations& stations) const {
  std::vector<Missing> out = away_;
  std::erase_if(out, [&](const Missing& one) { return stations.contains(one.station); });
  return out;
}

}  // namespace stationd::ctl

#include "dds_bridge/duplicate.hpp"

namespace stationd::bus {
namespace {

constexpr std::size_t kMostWriters = 1024;

std::uint32_t upper(std::uint64_t low) { return static_cast<std::uint32_t>(low >> 32U); }

}  // namespace

bool DuplicateWatch::own(const Origin& origin) const noexcept {
  return origin.writer_high == self_.writer_high && upper(origin.writer_low) == upper(self_.writer_low);
}

DuplicateWatch::Verdict DuplicateWatch::on_status(const Status& status, const Origin& origin,
                                                  std::int64_t now_ns) {
  if (own(origin)) return Verdict::none;
  if (writers_.size() > kMostWriters) writers_.clear();  // somebody plays with us
  Writer& writer = writers_[{origin.writer_high, origin.writer_low}];
  if (writer.samples != 0 && origin.sequence <= writer.sequence) return Verdict::none;
  writer.sequence = origin.sequence;
  if (++writer.samples < 2) return Verdict::none;
  if (now_ns - start_ns_ >= newcomer_ns_) return Verdict::report;
  // Its age as its scans tell it. Where both are new, the one with the greater GUID gives way.
  const bool it_is_new = static_cast<double>(status.SCANS) * static_cast<double>(status.PERIOD_NS) <
                         static_cast<double>(newcomer_ns_);
  if (!it_is_new) return Verdict::give_way;
  const std::pair ours{self_.writer_high, std::uint64_t{upper(self_.writer_low)}};
  const std::pair theirs{origin.writer_high, std::uint64_t{upper(origin.writer_low)}};
  return ours > theirs ? Verdict::give_way : Verdict::report;
}

}  // namespace stationd::bus

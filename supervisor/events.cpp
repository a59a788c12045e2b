#include "supervisor/events.hpp"

#include "dds_bridge/text.hpp"

namespace stationd::supervisor {
namespace {

constexpr std::size_t kMaxStations = 1000;   // names come over the network
constexpr std::size_t kMaxEpochs = 16;       // of one station
constexpr std::size_t kMaxScattered = 4096;  // SEQs above a gap

}  // namespace

bool EventList::Seen::insert(std::uint32_t seq) {
  if (seq <= floor || !above.insert(seq).second) return false;
  while (!above.empty() && (*above.begin() == floor + 1 || above.size() > kMaxScattered)) {
    floor = *above.begin();
    above.erase(above.begin());
  }
  return true;
}

bool EventList::add(const bus::Gse& gse, std::int64_t receipt_ns) {
  std::uint32_t missing_before = 0;
  if (gse.SEQ != 0) {
    if (seen_.size() >= kMaxStations && !seen_.contains(gse.STATION)) return false;
    Epochs& epochs = seen_[gse.STATION];
    const bool first = epochs.empty();
    if (epochs.size() >= kMaxEpochs && !epochs.contains(gse.EPOCH)) {
      if (gse.EPOCH < epochs.begin()->first) return false;
      epochs.erase(epochs.begin());
    }
    const auto [entry, fresh] = epochs.try_emplace(gse.EPOCH);
    Seen& seen = entry->second;
    // What a station reported before this list began is not missing.
    if (first && fresh) seen.floor = seen.last = gse.SEQ - 1;
    const std::uint32_t last = seen.last;
    if (!seen.insert(gse.SEQ)) return false;
    if (gse.SEQ > last) {
      missing_before = gse.SEQ - last - 1;
      missing_ += missing_before;
      seen.last = gse.SEQ;
    } else if (missing_ > 0) {
      --missing_;
    }
  }
  if (records_.size() >= capacity_) records_.pop_front();
  records_.push_back({gse, receipt_ns, missing_before, ++listed_});
  return true;
}

std::string event_text(const EventRecord& record) {
  const std::string lost = std::to_string(record.missing_before);
  return bus::event_text(record.gse) + (record.missing_before == 0 ? "" : " (" + lost + " lost before)");
}

}  // namespace stationd::supervisor

// Events: the list of what the stations reported (GSE), each once by (STATION, EPOCH, SEQ), bounded.
// Owned by the model.
// The model's thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>

#include "dds_bridge/messages.hpp"

namespace stationd::supervisor {

struct EventRecord {
  bus::Gse gse;
  std::int64_t receipt_ns = 0;       ///< CLOCK_MONOTONIC
  std::uint32_t missing_before = 0;  ///< events of the same station that were lost before this one
  std::uint64_t number = 0;          ///< counts the list's records from 1
};

/// One event in one line, with what was lost before it.
std::string event_text(const EventRecord& record);

class EventList {
 public:
  explicit EventList(std::size_t capacity) : capacity_(capacity) {}

  /// True if it was not listed yet. The oldest leaves when the list is full. An event without SEQ (a Table 4
  /// writer) cannot be told from its repetition and is listed always.
  bool add(const bus::Gse& gse, std::int64_t receipt_ns);

  const std::deque<EventRecord>& records() const noexcept { return records_; }
  std::uint64_t listed() const noexcept { return listed_; }    ///< ever
  std::uint64_t missing() const noexcept { return missing_; }  ///< gaps in SEQ not filled since

 private:
  /// Which SEQs of one station's epoch were seen. `floor`: that one and all below count as seen.
  struct Seen {
    std::uint32_t floor = 0;
    std::uint32_t last = 0;
    std::set<std::uint32_t> above;
    bool insert(std::uint32_t seq);
  };
  using Epochs = std::map<std::uint32_t, Seen>;

  std::size_t capacity_;
  std::deque<EventRecord> records_;
  std::map<std::string, Epochs> seen_;
  std::uint64_t listed_ = 0;
  std::uint64_t missing_ = 0;
};

}  // namespace stationd::supervisor

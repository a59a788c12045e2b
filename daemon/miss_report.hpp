// MissReport: turns a task's deadline misses into at most one log line a second, which says how many it
// stands for.
// Owned by housekeeping; one for each task.
// The housekeeping thread only; time is a value.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/log.hpp"
#include "scan/task.hpp"

namespace stationd {

class MissReport {
 public:
  MissReport(std::string task, std::vector<std::string> stations);

  /// A record from the task's ring. The worst one (greatest response time) since the last line is the one
  /// that is shown.
  void add(const CycleRecord& record);

  struct Line {
    std::string text;
    LogFields fields;
  };
  /// The line that is due at now_ns, if any: `misses` is the task's exact counter.
  std::optional<Line> due(std::int64_t now_ns, std::uint64_t misses);

 private:
  std::string task_;
  std::vector<std::string> stations_;
  std::optional<CycleRecord> worst_;
  std::uint64_t reported_ = 0;
  std::int64_t next_line_ns_ = 0;
};

}  // namespace stationd

// Log: the facade over spdlog; lines for people, and the same as journal fields under systemd.
// Owned by main(); everything else gets a reference.
// Any plain thread; never blocks on the sink (a full queue drops its oldest line). Not for scan
// threads.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "daemon/log_output.hpp"

namespace stationd {

/// Journal fields beside a line: names in capitals, as journald wants them ("STATION", "SCAN", ...).
using LogFields = std::vector<std::pair<std::string, std::string>>;

class Log {
 public:
  /// `output`: by default standard error, or the journal when standard error is connected to it.
  Log(const std::string& name, LogSeverity least, std::unique_ptr<LogOutput> output = standard_output());
  ~Log();
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  void line(LogSeverity severity, const std::string& text, const LogFields& fields = {});
  void debug(const std::string& text) { line(LogSeverity::debug, text); }
  void info(const std::string& text) { line(LogSeverity::info, text); }
  void warning(const std::string& text) { line(LogSeverity::warning, text); }
  void error(const std::string& text) { line(LogSeverity::error, text); }
  /// Lines below `least` are dropped (SIGHUP applies a new one).
  void set_least(LogSeverity least);
  /// Lines that left the full queue unseen because the output is slower than what is said.
  std::uint64_t dropped() const;
  /// Says how many were dropped, when there are more than it said before; at most once a second. To be called
  /// now and then, by one thread.
  void report_dropped(std::int64_t now_ns);
  /// Waits until what was said is out, half a second at most; false: it is not. So does the destructor: an
  /// output that is stuck (a pipe that nobody reads) does not keep the process from ending.
  bool flush();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::uint64_t dropped_said_ = 0;
  std::int64_t next_report_ns_ = 0;
};

}  // namespace stationd

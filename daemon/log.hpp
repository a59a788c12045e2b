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

namespace stationd {

enum class LogSeverity : std::uint8_t { debug, info, warning, error };

/// Journal fields beside a line: names in capitals, as journald wants them ("STATION", "SCAN", ...).
using LogFields = std::vector<std::pair<std::string, std::string>>;

class Log {
 public:
  /// To standard error; to the journal with fields when standard error is connected to it ($JOURNAL_STREAM).
  Log(const std::string& name, LogSeverity least);
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
  /// Asks for what was said to go out now; the destructor waits for it.
  void flush();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stationd

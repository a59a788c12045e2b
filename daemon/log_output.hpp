// LogOutput: where log lines go: plain text on standard error, or the journal with its fields.
// Owned by the log.
// The log's own thread, one line at a time.
#pragma once

#include <sys/uio.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace stationd {

enum class LogSeverity : std::uint8_t { debug, info, warning, error };

/// One line as it goes out.
struct LogRecord {
  LogSeverity severity = LogSeverity::info;
  std::string_view text;                 ///< what was said
  std::string_view line;                 ///< the same with time, name and severity before it
  std::vector<std::string_view> fields;  ///< "NAME=value"
};

/// Seam: what takes the lines.
class LogOutput {
 public:
  virtual ~LogOutput() = default;
  /// May block; may not throw.
  virtual void write(const LogRecord& record) = 0;
};

/// Lines for people; fields are left out. Not through stdio: a thread that is stuck in a write there holds a
/// lock that the process's end waits for.
class PlainOutput final : public LogOutput {
 public:
  explicit PlainOutput(int descriptor) : descriptor_(descriptor) {}
  void write(const LogRecord& record) override;

 private:
  int descriptor_;
};

/// Entries with MESSAGE, PRIORITY and the line's fields. The journal has a time and a name of its own.
class JournalOutput final : public LogOutput {
 public:
  using Send = std::function<int(const iovec* fields, int count)>;
  explicit JournalOutput(Send send) : send_(std::move(send)) {}
  void write(const LogRecord& record) override;

 private:
  Send send_;
};

/// Whether `descriptor` is the stream that journald named in $JOURNAL_STREAM (DEVICE:INODE); null: it named
/// none.
bool is_journal(const char* journal_stream, int descriptor);

/// To the journal when standard error is connected to it, else to standard error.
std::unique_ptr<LogOutput> standard_output();

}  // namespace stationd

#include "daemon/log_output.hpp"

#include <sys/stat.h>
#include <systemd/sd-journal.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <string>

namespace stationd {

void PlainOutput::write(const LogRecord& record) {
  std::string_view rest = record.line;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written < 0 && errno != EINTR) return;  // there is nowhere to say so
    if (written > 0) rest.remove_prefix(static_cast<std::size_t>(written));
  }
}

void JournalOutput::write(const LogRecord& record) {
  static constexpr std::array<const char*, 4> priorities = {"PRIORITY=7", "PRIORITY=6", "PRIORITY=4",
                                                            "PRIORITY=3"};
  const std::string priority = priorities[static_cast<std::size_t>(record.severity)];
  const std::string message = "MESSAGE=" + std::string(record.text);
  std::vector<std::string_view> fields = {priority, message};
  fields.insert(fields.end(), record.fields.begin(), record.fields.end());
  std::vector<iovec> parts;
  for (const std::string_view f : fields)
    parts.push_back({const_cast<char*>(f.data()), f.size()});  // only read
  static_cast<void>(send_(parts.data(), static_cast<int>(parts.size())));
}

bool is_journal(const char* journal_stream, int descriptor) {
  struct stat status {};
  if (journal_stream == nullptr || fstat(descriptor, &status) != 0) return false;
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino) == journal_stream;
}

std::unique_ptr<LogOutput> standard_output() {
  if (is_journal(std::getenv("JOURNAL_STREAM"), STDERR_FILENO))
    return std::make_unique<JournalOutput>(sd_journal_sendv);
  return std::make_unique<PlainOutput>(STDERR_FILENO);
}

}  // namespace stationd

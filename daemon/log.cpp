#include "daemon/log.hpp"

#include <spdlog/async.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <systemd/sd-journal.h>

#include <array>
#include <cstdlib>

namespace stationd {
namespace {

constexpr std::size_t kQueue = 2048;
constexpr char kFieldSeparator =
    '\x1f';  // text, then NAME=value ... : fields travel inside the line to the sink

spdlog::level::level_enum level_of(LogSeverity severity) {
  static constexpr std::array levels = {spdlog::level::debug, spdlog::level::info, spdlog::level::warn,
                                        spdlog::level::err};
  return levels[static_cast<std::size_t>(severity)];
}

/// Journald sets $JOURNAL_STREAM to DEVICE:INODE of the stream it gave us; anything else on fd 2 is not the
/// journal.
bool stderr_is_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  if (stream == nullptr || fstat(2, &status) != 0) return false;
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino) == stream;
}

/// Text from the network must not forge lines or fields.
std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

std::string_view without_fields(std::string_view payload) {
  return payload.substr(0, payload.find(kFieldSeparator));
}

/// Plain lines; journal fields are left out.
class PlainSink final : public spdlog::sinks::base_sink<std::mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::details::log_msg plain = message;
    const std::string_view text = without_fields({message.payload.data(), message.payload.size()});
    plain.payload = spdlog::string_view_t(text.data(), text.size());
    spdlog::memory_buf_t line;
    formatter_->format(plain, line);
    std::fwrite(line.data(), 1, line.size(), stderr);
  }
  void flush_() override { std::fflush(stderr); }
};

class JournalSink final : public spdlog::sinks::base_sink<std::mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    static constexpr std::array<const char*, 7> priorities = {"7", "7", "6", "4", "3", "2", "5"};
    std::vector<std::string> fields = {std::string("PRIORITY=") +
                                       priorities[static_cast<std::size_t>(message.level)]};
    std::string_view rest(message.payload.data(), message.payload.size());
    for (bool first = true;; first = false) {
      const std::size_t end = rest.find(kFieldSeparator);
      fields.push_back((first ? "MESSAGE=" : "") + std::string(rest.substr(0, end)));
      if (end == std::string_view::npos) break;
      rest.remove_prefix(end + 1);
    }
    std::vector<iovec> parts;
    for (std::string& f : fields) parts.push_back({f.data(), f.size()});
    sd_journal_sendv(parts.data(), static_cast<int>(parts.size()));
  }
  void flush_() override {}
};

}  // namespace

struct Log::Impl {
  std::shared_ptr<spdlog::details::thread_pool> pool;
  std::shared_ptr<spdlog::async_logger> logger;
};

Log::Log(const std::string& name, LogSeverity least) : impl_(std::make_unique<Impl>()) {
  spdlog::sink_ptr sink;
  if (stderr_is_journal())
    sink = std::make_shared<JournalSink>();
  else
    sink = std::make_shared<PlainSink>();
  sink->set_formatter(std::make_unique<spdlog::pattern_formatter>("%Y-%m-%dT%H:%M:%S.%eZ %n %l: %v",
                                                                  spdlog::pattern_time_type::utc));
  impl_->pool = std::make_shared<spdlog::details::thread_pool>(kQueue, 1);
  impl_->logger = std::make_shared<spdlog::async_logger>(name, sink, impl_->pool,
                                                         spdlog::async_overflow_policy::overrun_oldest);
  impl_->logger->flush_on(spdlog::level::info);
  set_least(least);
}

Log::~Log() { flush(); }

void Log::line(LogSeverity severity, const std::string& text, const LogFields& fields) {
  std::string payload = printable(text);
  for (const auto& [key, value] : fields) payload += kFieldSeparator + key + "=" + printable(value);
  impl_->logger->log(level_of(severity), spdlog::string_view_t(payload.data(), payload.size()));
}

void Log::set_least(LogSeverity least) { impl_->logger->set_level(level_of(least)); }

void Log::flush() { impl_->logger->flush(); }

}  // namespace stationd

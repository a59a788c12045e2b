#include "daemon/log.hpp"

#include <spdlog/async.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <array>
#include <atomic>
#include <chrono>
#include <string_view>
#include <thread>

namespace stationd {
namespace {

constexpr std::size_t kQueue = 2048;
constexpr std::int64_t kReportEveryNs = 1'000'000'000;
constexpr int kFlushLimitMs = 500;
constexpr char kFieldSeparator =
    '\x1f';  // text, then NAME=value ... : fields travel inside the line to the sink

spdlog::level::level_enum level_of(LogSeverity severity) {
  static constexpr std::array levels = {spdlog::level::debug, spdlog::level::info, spdlog::level::warn,
                                        spdlog::level::err};
  return levels[static_cast<std::size_t>(severity)];
}

/// Text from the network must not forge lines or fields.
std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

LogSeverity severity_of(spdlog::level::level_enum level) {
  if (level >= spdlog::level::err) return LogSeverity::error;
  if (level == spdlog::level::warn) return LogSeverity::warning;
  return level == spdlog::level::info ? LogSeverity::info : LogSeverity::debug;
}

/// Takes the fields out of the payload again and hands all to the output.
class OutputSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit OutputSink(std::unique_ptr<LogOutput> output) : output_(std::move(output)) {}
  /// How many marks put into the queue by flush() have come through.
  std::uint64_t flushes() const noexcept { return flushes_.load(); }

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    LogRecord record;
    record.severity = severity_of(message.level);
    std::string_view rest(message.payload.data(), message.payload.size());
    for (bool first = true;; first = false) {
      const std::size_t end = rest.find(kFieldSeparator);
      if (first)
        record.text = rest.substr(0, end);
      else
        record.fields.push_back(rest.substr(0, end));
      if (end == std::string_view::npos) break;
      rest.remove_prefix(end + 1);
    }
    spdlog::details::log_msg plain = message;
    plain.payload = spdlog::string_view_t(record.text.data(), record.text.size());
    spdlog::memory_buf_t line;
    formatter_->format(plain, line);
    record.line = {line.data(), line.size()};
    output_->write(record);
  }
  void flush_() override { flushes_.fetch_add(1); }

 private:
  std::unique_ptr<LogOutput> output_;
  std::atomic<std::uint64_t> flushes_{0};
};

}  // namespace

struct Log::Impl {
  std::shared_ptr<OutputSink> sink;
  std::uint64_t flushes = 0;
  std::shared_ptr<spdlog::details::thread_pool> pool;
  std::shared_ptr<spdlog::async_logger> logger;
};

Log::Log(const std::string& name, LogSeverity least, std::unique_ptr<LogOutput> output)
    : impl_(std::make_unique<Impl>()) {
  impl_->sink = std::make_shared<OutputSink>(std::move(output));
  impl_->sink->set_formatter(std::make_unique<spdlog::pattern_formatter>("%Y-%m-%dT%H:%M:%S.%eZ %n %l: %v",
                                                                         spdlog::pattern_time_type::utc));
  impl_->pool = std::make_shared<spdlog::details::thread_pool>(kQueue, 1);
  impl_->logger = std::make_shared<spdlog::async_logger>(name, impl_->sink, impl_->pool,
                                                         spdlog::async_overflow_policy::overrun_oldest);
  set_least(least);
}

Log::~Log() {
  if (flush()) return;
  // The output is stuck and its thread with it: both are left to the end of the process.
  [[maybe_unused]] static Impl* volatile abandoned;
  abandoned = impl_.release();
}

void Log::line(LogSeverity severity, const std::string& text, const LogFields& fields) {
  std::string payload = printable(text);
  for (const auto& [key, value] : fields) payload += kFieldSeparator + key + "=" + printable(value);
  impl_->logger->log(level_of(severity), spdlog::string_view_t(payload.data(), payload.size()));
}

void Log::set_least(LogSeverity least) { impl_->logger->set_level(level_of(least)); }

std::uint64_t Log::dropped() const { return impl_->pool->overrun_counter(); }

void Log::report_dropped(std::int64_t now_ns) {
  const std::uint64_t count = dropped();
  if (count == dropped_said_ || now_ns < next_report_ns_) return;
  const std::uint64_t fresh = count - dropped_said_;
  line(LogSeverity::warning,
       "log lines dropped: " + std::to_string(fresh) + " since the last such line, " + std::to_string(count) +
           " in all: whatever takes the log is slower than what is said",
       {{"STATIOND_EVENT", "log_dropped"}, {"STATIOND_COUNT", std::to_string(fresh)}});
  dropped_said_ = count;
  next_report_ns_ = now_ns + kReportEveryNs;
}

bool Log::flush() {
  const std::uint64_t wanted = ++impl_->flushes;
  impl_->logger->flush();
  for (int waited_ms = 0; waited_ms < kFlushLimitMs; ++waited_ms) {
    if (impl_->sink->flushes() >= wanted) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

}  // namespace stationd

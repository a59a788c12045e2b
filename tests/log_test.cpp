// The log: what goes to the journal and what to standard error, and an output that takes nothing.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <array>
#include <condition_variable>
#include <cstdio>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "daemon/log.hpp"

namespace stationd {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;

using Entries = std::vector<std::vector<std::string>>;

/// Remembers entries as journald would get them.
std::unique_ptr<LogOutput> journal_into(Entries& entries) {
  return std::make_unique<JournalOutput>([&entries](const iovec* parts, int count) {
    std::vector<std::string> entry;
    for (int i = 0; i < count; ++i)
      entry.emplace_back(static_cast<const char*>(parts[i].iov_base), parts[i].iov_len);
    entries.push_back(std::move(entry));
    return 0;
  });
}

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

File temporary() { return {std::tmpfile(), std::fclose}; }

std::string content(std::FILE* file) {
  std::string text;
  std::array<char, 4096> part{};
  std::rewind(file);
  while (const std::size_t got = std::fread(part.data(), 1, part.size(), file)) text.append(part.data(), got);
  return text;
}

/// Takes lines only while its gate is open.
struct Gate {
  std::mutex mutex;
  std::condition_variable changed;
  bool open = false;
  bool waiting = false;
  std::vector<std::string> lines;

  void set_open() {
    const std::lock_guard lock(mutex);
    open = true;
    changed.notify_all();
  }
  void wait_until_stuck() {
    std::unique_lock lock(mutex);
    changed.wait(lock, [this] { return waiting; });
  }
  std::size_t count(const std::string& part) {
    const std::lock_guard lock(mutex);
    std::size_t count = 0;
    for (const std::string& line : lines) count += line.find(part) != std::string::npos;
    return count;
  }
};

class GatedOutput final : public LogOutput {
 public:
  explicit GatedOutput(std::shared_ptr<Gate> gate) : gate_(std::move(gate)) {}
  void write(const LogRecord& record) override {
    std::unique_lock lock(gate_->mutex);
    gate_->waiting = true;
    gate_->changed.notify_all();
    gate_->changed.wait(lock, [this] { return gate_->open; });
    gate_->lines.emplace_back(record.text);
  }

 private:
  std::shared_ptr<Gate> gate_;
};

TEST_CASE("Journal gets message, priority and fields of each line (SCAN-4)") {
  Entries entries;
  {
    Log log("controller1", LogSeverity::debug, journal_into(entries));
    log.line(LogSeverity::warning, "deadline miss", {{"STATIOND_TASK", "fast"}, {"STATIOND_SCAN", "41"}});
    log.debug("d");
    log.info("i");
    log.error("e");
  }
  REQUIRE(entries.size() == 4);
  using Entry = std::vector<std::string>;
  CHECK(entries[0] == Entry{"PRIORITY=4", "MESSAGE=deadline miss", "STATIOND_TASK=fast", "STATIOND_SCAN=41"});
  CHECK(entries[1] == Entry{"PRIORITY=7", "MESSAGE=d"});
  CHECK(entries[2] == Entry{"PRIORITY=6", "MESSAGE=i"});
  CHECK(entries[3] == Entry{"PRIORITY=3", "MESSAGE=e"});
}

TEST_CASE("Standard error gets one line each with name and severity, without the fields (SCAN-4)") {
  const File file = temporary();
  {
    Log log("controller1", LogSeverity::info, std::make_unique<PlainOutput>(fileno(file.get())));
    log.line(LogSeverity::warning, "deadline miss", {{"STATIOND_TASK", "fast"}});
    log.info("two");
  }
  const std::string text = content(file.get());
  CHECK(text.find("Z controller1 warning: deadline miss\n") != std::string::npos);
  CHECK(text.find("Z controller1 info: two\n") != std::string::npos);
  CHECK(text.find("STATIOND_TASK") == std::string::npos);
}

TEST_CASE("Text from elsewhere forges neither a line nor a field (REQ-5)") {
  Entries entries;
  {
    Log("c", LogSeverity::info, journal_into(entries))
        .line(LogSeverity::info, "a\nb\x1fPRIORITY=0", {{"X", "1\n2"}});
  }
  REQUIRE(entries.size() == 1);
  CHECK(entries[0] == std::vector<std::string>{"PRIORITY=6", "MESSAGE=a?b?PRIORITY=0", "X=1?2"});
}

TEST_CASE("Lines below the least severity are left out, and a new one takes effect at once (SYS-1)") {
  Entries entries;
  {
    Log log("c", LogSeverity::warning, journal_into(entries));
    log.info("not");
    log.set_least(LogSeverity::info);
    log.info("this");
    log.debug("nor this");
  }
  REQUIRE(entries.size() == 1);
  CHECK(entries[0][1] == "MESSAGE=this");
}

TEST_CASE("Journal is the stream that journald named, and nothing else (SCAN-4)") {
  const File file = temporary();
  const int descriptor = fileno(file.get());
  struct stat status {};
  REQUIRE(fstat(descriptor, &status) == 0);
  const std::string named = std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
  CHECK(is_journal(named.c_str(), descriptor));
  CHECK_FALSE(is_journal(nullptr, descriptor));
  CHECK_FALSE(is_journal("", descriptor));
  CHECK_FALSE(is_journal((named + "1").c_str(), descriptor));
  CHECK_FALSE(is_journal(named.c_str(), -1));
}

TEST_CASE(
    "Lines that a slow output makes the log drop are counted and said, once a second at most (SCAN-4)") {
  constexpr int said = 5'000;  // more than the queue holds
  const auto gate = std::make_shared<Gate>();
  std::uint64_t dropped = 0;
  {
    Log log("c", LogSeverity::info, std::make_unique<GatedOutput>(gate));
    log.report_dropped(0);
    for (int i = 0; i < said; ++i) log.info("x");
    gate->set_open();
    REQUIRE(log.flush());
    dropped = log.dropped();
    log.report_dropped(kSecondNs);
    log.report_dropped(kSecondNs + kSecondNs / 2);
    log.report_dropped(3 * kSecondNs);  // none more: nothing more to say
  }
  CHECK(dropped > 2'000);
  CHECK(gate->count("x") + dropped == said);
  CHECK(gate->count("log lines dropped: ") == 1);
  CHECK(gate->count("log lines dropped: " + std::to_string(dropped) + " since the last such line, " +
                    std::to_string(dropped) + " in all") == 1);
}

TEST_CASE("Dropped lines that follow are said a second later, with those since and all (SCAN-4)") {
  const auto gate = std::make_shared<Gate>();
  Log log("c", LogSeverity::info, std::make_unique<GatedOutput>(gate));
  for (int i = 0; i < 5'000; ++i) log.info("x");
  log.report_dropped(kSecondNs);
  const std::uint64_t first = log.dropped();
  for (int i = 0; i < 100; ++i) log.info("x");
  log.report_dropped(2 * kSecondNs - 1);
  gate->set_open();
  REQUIRE(log.flush());
  const std::uint64_t all = log.dropped();
  CHECK(all >= first + 100);
  log.report_dropped(2 * kSecondNs);
  REQUIRE(log.flush());
  CHECK(gate->count(", " + std::to_string(all) + " in all") == 1);
}

TEST_CASE("Output that is stuck does not keep the log from ending (SYS-1)") {
  const auto gate = std::make_shared<Gate>();
  {
    Log log("c", LogSeverity::info, std::make_unique<GatedOutput>(gate));
    log.info("x");
    gate->wait_until_stuck();
    CHECK_FALSE(log.flush());
  }
  CHECK(gate->count("x") == 0);
  gate->set_open();  // the thread that was left behind goes on
}

}  // namespace
}  // namespace stationd

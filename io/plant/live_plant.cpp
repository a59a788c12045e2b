#include "io/plant/live_plant.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

namespace stationd::plant {

namespace {

constexpr std::int64_t kLedgerPeriod = 250'000'000;
constexpr std::int64_t kStatePeriod = 200'000'000;
constexpr std::int64_t kGapMax = 1'000'000'000;
constexpr std::int64_t kNsPerByte = 500;  // a text of 1 MB takes some 10 ms to make: at most each half second

std::int64_t period_for(std::int64_t period_ns, const std::string& text) noexcept {
  return std::max(period_ns, static_cast<std::int64_t>(text.size()) * kNsPerByte);
}

void write_all(int fd, const std::string& text, const std::string& path) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t put = ::write(fd, text.data() + done, text.size() - done);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) throw std::system_error(errno, std::generic_category(), "cannot write " + path);
    done += static_cast<std::size_t>(put);
  }
}

}  // namespace

void write_atomically(const std::string& path, const std::string& text) {
  const std::string temporary = path + ".tmp";
  const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) throw std::system_error(errno, std::generic_category(), "cannot write " + temporary);
  try {
    write_all(fd, text, temporary);
  } catch (...) {
    ::close(fd);
    throw;
  }
  ::close(fd);
  if (std::rename(temporary.c_str(), path.c_str()) != 0) {
    throw std::system_error(errno, std::generic_category(), "cannot write " + path);
  }
}

LivePlant::LivePlant(PlantConfig config, LiveOptions options)
    : plant_(std::move(config)), options_(std::move(options)) {
  if (options_.state_file.empty()) return;
  std::ifstream file(options_.state_file, std::ios::binary);
  if (!file) return;  // the first start
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  try {
    plant_.load(text);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(options_.state_file + ": " + error.what());
  }
}

void LivePlant::advance(std::int64_t now_ns) {
  if (!started_ || now_ns - last_now_ns_ > kGapMax) {
    real_origin_ns_ = started_ ? now_ns - kGapMax : now_ns;
    plant_origin_ns_ = plant_.now_ns();
    started_ = true;
  }
  last_now_ns_ = now_ns;
  const double passed_ns = static_cast<double>(now_ns - real_origin_ns_) * options_.speed;
  plant_.advance_to(plant_origin_ns_ + static_cast<std::int64_t>(passed_ns));
}

LivePlant::Due LivePlant::due(std::int64_t now_ns) {
  Due due;
  if (!options_.ledger_file.empty() && now_ns >= ledger_due_ns_) {
    due.ledger = plant_.ledger().to_json(plant_.now_ns(), false);
    ledger_due_ns_ = now_ns + period_for(kLedgerPeriod, due.ledger);
  }
  if (!options_.state_file.empty() && now_ns >= state_due_ns_) {
    due.state = plant_.save();
    state_due_ns_ = now_ns + period_for(kStatePeriod, due.state);
  }
  return due;
}

void LivePlant::write(const Due& due) const {
  if (!due.ledger.empty()) write_atomically(options_.ledger_file, due.ledger);
  if (!due.state.empty()) write_atomically(options_.state_file, due.state);
}

void LivePlant::finish() {
  Due last;
  if (!options_.ledger_file.empty()) last.ledger = plant_.ledger().to_json(plant_.now_ns(), true);
  if (!options_.state_file.empty()) last.state = plant_.save();
  write(last);
}

}  // namespace stationd::plant

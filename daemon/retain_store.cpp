#include "daemon/retain_store.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "scan/error.hpp"

namespace stationd {
namespace {

constexpr std::array<char, 8> kMagic = {'S', 'T', 'R', 'E', 'T', '0', '0', '1'};

struct FileHeader {
  std::array<char, 8> magic = kMagic;
  std::uint64_t layout = 0;
  std::uint64_t generation = 0;
  std::uint32_t epoch = 0;
  std::uint32_t slots = 0;
};

enum class Verdict { valid, absent, other_layout, damaged };

struct ReadBack {
  Verdict verdict = Verdict::absent;
  FileHeader header;
  std::vector<Slot> slots;
};

std::uint32_t checksum(const std::byte* bytes, std::size_t size) {
  return static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(bytes), static_cast<uInt>(size)));
}

ReadBack read_back(const std::filesystem::path& path, std::uint64_t layout) {
  ReadBack result;
  std::ifstream file(path, std::ios::binary);
  if (!file) return result;
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  result.verdict = Verdict::damaged;
  if (bytes.size() < sizeof(FileHeader) + sizeof(std::uint32_t)) return result;
  std::memcpy(&result.header, bytes.data(), sizeof(FileHeader));
  const std::size_t body = sizeof(FileHeader) + std::size_t{result.header.slots} * sizeof(Slot);
  if (result.header.magic != kMagic || bytes.size() != body + sizeof(std::uint32_t)) return result;
  std::uint32_t stored = 0;
  std::memcpy(&stored, bytes.data() + body, sizeof stored);
  if (stored != checksum(reinterpret_cast<const std::byte*>(bytes.data()), body)) return result;
  result.slots.resize(result.header.slots);
  if (result.header.slots != 0)
    std::memcpy(result.slots.data(), bytes.data() + sizeof(FileHeader), result.slots.size() * sizeof(Slot));
  result.verdict = result.header.layout == layout ? Verdict::valid : Verdict::other_layout;
  return result;
}

void hash_in(std::uint64_t& hash, std::string_view text) {
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;  // FNV-1a
}

}  // namespace

std::uint64_t layout_hash(const Image& image, std::span<const TagIndex> tags) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const TagIndex tag : tags) {
    const TagSpec& spec = image.spec(tag);
    hash_in(hash, spec.name);
    hash_in(hash, ":");
    hash_in(hash, name_of(spec.type));
    hash_in(hash, std::to_string(spec.length) + ";");
  }
  return hash;
}

RetainStore::RetainStore(const std::filesystem::path& directory, std::string station, std::uint64_t layout)
    : directory_(directory), station_(std::move(station)), layout_(layout) {
  std::error_code e;
  std::filesystem::create_directories(directory_, e);
  if (e || access(directory_.c_str(), W_OK | X_OK) != 0)
    throw SetupError(
        "state directory " + directory_.string() +
        " cannot be written: " + (e ? e.message() : std::string(std::strerror(errno))) +
        "; set [controller] state_dir or $STATE_DIRECTORY to a directory that this user may write");
}

RetainStore::~RetainStore() {
  for (const int fd : descriptors_)
    if (fd >= 0) close(fd);
}

std::filesystem::path RetainStore::path(int generation) const {
  return directory_ / (station_ + ".retained." + std::to_string(generation & 1));
}

RetainStore::Loaded RetainStore::load() {
  Loaded result;
  std::uint64_t newest_valid = 0;
  for (int i = 0; i < 2; ++i) {
    ReadBack back = read_back(path(i), layout_);
    if (back.verdict == Verdict::absent) continue;
    if (back.verdict != Verdict::damaged) {
      result.epoch = std::max(result.epoch, back.header.epoch);
      generation_ = std::max(generation_, back.header.generation);
    }
    if (back.verdict == Verdict::valid) {
      if (!result.record || back.header.generation > newest_valid)
        result.record = RetainRecord{back.header.epoch, std::move(back.slots)};
      newest_valid = std::max(newest_valid, back.header.generation);
      continue;
    }
    const auto aside = path(i).string() + ".refused";
    std::error_code ignored;
    std::filesystem::rename(path(i), aside, ignored);
    result.refused +=
        (result.refused.empty() ? "" : "; ") + path(i).string() +
        (back.verdict == Verdict::damaged ? " is damaged or truncated" : " is of another layout") +
        ", kept aside as " + aside;
  }
  return result;
}

bool RetainStore::open_file(int index) {
  if (descriptors_[index] >= 0) return true;
  descriptors_[index] = open(path(index).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0640);
  if (descriptors_[index] < 0) return false;
  // The name itself has to outlive a power cut, too.
  const int directory = open(directory_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory < 0) return false;
  const bool synced = fsync(directory) == 0;
  close(directory);
  return synced;
}

bool RetainStore::save(std::uint32_t epoch, std::span<const Slot> slots) {
  FileHeader header;
  header.layout = layout_;
  header.generation = generation_ + 1;
  header.epoch = epoch;
  header.slots = static_cast<std::uint32_t>(slots.size());
  const std::size_t body = sizeof header + slots.size_bytes();
  buffer_.resize(body + sizeof(std::uint32_t));
  std::memcpy(buffer_.data(), &header, sizeof header);
  if (!slots.empty()) std::memcpy(buffer_.data() + sizeof header, slots.data(), slots.size_bytes());
  const std::uint32_t sum = checksum(buffer_.data(), body);
  std::memcpy(buffer_.data() + body, &sum, sizeof sum);

  const int index = static_cast<int>(header.generation & 1);
  const int fd = open_file(index) ? descriptors_[index] : -1;
  const auto size = static_cast<ssize_t>(buffer_.size());
  if (fd < 0 || pwrite(fd, buffer_.data(), buffer_.size(), 0) != size || ftruncate(fd, size) != 0 ||
      fdatasync(fd) != 0) {
    error_ = path(index).string() + ": " + std::strerror(errno);
    return false;
  }
  ++generation_;
  return true;
}

}  // namespace stationd

#include "daemon/retain_store.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

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

/// The whole content; else the errno why not.
int read_file(const std::filesystem::path& path, std::vector<std::byte>& bytes) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return errno;
  std::array<std::byte, 4096> part{};
  ssize_t got = 0;
  while ((got = read(fd, part.data(), part.size())) > 0)
    bytes.insert(bytes.end(), part.begin(), part.begin() + got);
  const int error = got < 0 ? errno : 0;
  close(fd);
  return error;
}

ReadBack read_back(const std::filesystem::path& path, std::uint64_t layout) {
  ReadBack result;
  std::vector<std::byte> bytes;
  const int error = read_file(path, bytes);
  if (error == ENOENT) return result;
  result.verdict = Verdict::damaged;
  if (error != 0 || bytes.size() < sizeof(FileHeader) + sizeof(std::uint32_t)) return result;
  std::memcpy(&result.header, bytes.data(), sizeof(FileHeader));
  const std::size_t body = sizeof(FileHeader) + std::size_t{result.header.slots} * sizeof(Slot);
  if (result.header.magic != kMagic || bytes.size() != body + sizeof(std::uint32_t)) return result;
  std::uint32_t stored = 0;
  std::memcpy(&stored, bytes.data() + body, sizeof stored);
  if (stored != checksum(bytes.data(), body)) return result;
  result.slots.resize(result.header.slots);
  if (result.header.slots != 0)
    std::memcpy(result.slots.data(), bytes.data() + sizeof(FileHeader), result.slots.size() * sizeof(Slot));
  result.verdict = result.header.layout == layout ? Verdict::valid : Verdict::other_layout;
  return result;
}

/// True once the names in the directory are on disk. Sets errno.
bool sync_directory(const std::filesystem::path& directory) {
  const int fd = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool synced = fsync(fd) == 0;
  close(fd);
  return synced;
}

bool write_and_sync(int fd, std::span<const std::byte> bytes) {
  const auto size = static_cast<ssize_t>(bytes.size());
  const ssize_t written = pwrite(fd, bytes.data(), bytes.size(), 0);
  if (written >= 0 && written < size) errno = ENOSPC;
  return written == size && ftruncate(fd, size) == 0 && fdatasync(fd) == 0;
}

/// Replaces the file's content; 0 once it is on disk, else the errno why not. Opened by name each time: a
/// file that was moved or deleted meanwhile is made anew, and its name then has to outlive a power cut, too.
int write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  bool made = false;
  int fd = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (fd < 0 && errno == ENOENT) {
    made = true;
    fd = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0640);
  }
  if (fd < 0) return errno;
  const bool written = write_and_sync(fd, bytes) && (!made || sync_directory(path.parent_path()));
  const int error = written ? 0 : errno;
  close(fd);
  return error;
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

RetainStore::RetainStore(std::filesystem::path directory, const std::string& controller,
                         const std::string& station, std::uint64_t layout)
    : directory_(std::move(directory)), name_(controller + "." + station + ".retained."),
      old_name_(station + ".retained."), layout_(layout) {
  std::error_code e;
  std::filesystem::create_directories(directory_, e);
  if (e || access(directory_.c_str(), W_OK | X_OK) != 0)
    throw StateDirectoryError(
        "state directory " + directory_.string() +
        " cannot be written: " + (e ? e.message() : std::string(std::strerror(errno))) +
        "; set [controller] state_dir or $STATE_DIRECTORY to a directory that this user may "
        "write");
}

std::filesystem::path RetainStore::path(int index) const {
  return directory_ / (name_ + std::to_string(index));
}

/// Which were renamed, for the log. Each by itself, so that a kill between the two loses none.
std::string RetainStore::adopt() {
  std::string adopted;
  for (int i = 0; i < 2; ++i) {
    const std::filesystem::path old = directory_ / (old_name_ + std::to_string(i));
    std::error_code e;
    if (std::filesystem::exists(path(i), e)) continue;
    std::filesystem::rename(old, path(i), e);
    if (!e) adopted += (adopted.empty() ? "" : ", ") + old.string() + " as " + path(i).string();
  }
  if (!adopted.empty()) sync_directory(directory_);
  return adopted;
}

std::string RetainStore::put_aside(int index, std::string_view why) const {
  const std::string from = path(index).string();
  const std::string aside = from + ".refused";
  std::error_code e;
  std::filesystem::rename(from, aside, e);
  return from + std::string(why) + (e ? ", not kept aside: " + e.message() : ", kept aside as " + aside);
}

RetainStore::Loaded RetainStore::load() {
  Loaded result;
  result.adopted = adopt();
  std::uint64_t newest_valid = 0;
  bool damaged = false;
  const auto refuse = [&](int index, std::string_view why) {
    result.refused += (result.refused.empty() ? "" : "; ") + put_aside(index, why);
  };
  for (int i = 0; i < 2; ++i) {
    ReadBack back = read_back(path(i), layout_);
    if (back.verdict == Verdict::absent) continue;
    if (back.verdict == Verdict::damaged) {
      damaged = true;
      refuse(i, " is damaged or truncated");
      continue;
    }
    result.epoch = std::max(result.epoch, back.header.epoch);
    generation_ = std::max(generation_, back.header.generation);
    if (back.verdict == Verdict::other_layout) {
      refuse(i, " is of another layout");
      continue;
    }
    if (result.record && back.header.generation < newest_valid) continue;
    result.record = RetainRecord{back.header.epoch, std::move(back.slots)};
    newest_valid = back.header.generation;
    next_ = 1 - i;
  }
  if (damaged && result.epoch != 0) ++result.epoch;
  return result;
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

  if (const int error = write_file(path(next_), buffer_); error != 0) {
    error_ = path(next_).string() + ": " + std::strerror(error);
    return false;
  }
  ++generation_;
  next_ = 1 - next_;
  return true;
}

}  // namespace stationd

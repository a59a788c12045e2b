#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include "supervisor/state.hpp"

namespace stationd::supervisor {
namespace {

std::string why(const std::filesystem::path& file) { return file.string() + ": " + std::strerror(errno); }

/// The error that keeps the supervisor from starting, and what to do about it.
[[noreturn]] void refuse(const std::string& what) {
  throw SetupError(
      "the state cannot be written: " + what +
      "; set [supervisor] state_dir or $STATE_DIRECTORY to a directory that this user may write, "
      "or take --observe, which saves nothing");
}

bool write_all(int fd, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(fd, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

/// The rename outlives a power cut once the folder is synced.
void sync_folder(const std::filesystem::path& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  ::fsync(fd);
  ::close(fd);
}

bool is_file_of(int fd, const std::string& path) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(fd, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
         opened.st_dev == named.st_dev;
}

}  // namespace

FileStateStore::FileStateStore(std::filesystem::path file) : file_(std::move(file)) {
  const std::filesystem::path folder = file_.parent_path();
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  if (error) refuse(folder.string() + ": " + error.message());
  const std::string lock = file_.string() + ".lock";
  while (lock_fd_ < 0) {
    lock_fd_ = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (lock_fd_ < 0) refuse(why(lock));
    if (::flock(lock_fd_, LOCK_EX | LOCK_NB) != 0) {
      const bool taken = errno == EWOULDBLOCK;
      const std::string text = why(lock);
      ::close(lock_fd_);
      if (!taken) refuse(text);
      throw StateTaken(file_.string() +
                       ": another supervisor keeps its state there; end it, or start this "
                       "one with --observe");
    }
    if (is_file_of(lock_fd_, lock)) break;
    // Its owner removed it between our open and our lock: this is nobody's lock.
    ::close(lock_fd_);
    lock_fd_ = -1;
  }
}

FileStateStore::~FileStateStore() {
  ::unlink((file_.string() + ".lock").c_str());
  ::close(lock_fd_);
}

SavedState FileStateStore::load(std::string& problem) {
  problem.clear();
  std::ifstream in(file_, std::ios::binary);
  if (!in) {
    if (std::filesystem::exists(file_)) problem = why(file_);
    return {};
  }
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (std::optional<SavedState> state = decode(text)) return *std::move(state);
  const std::string aside = file_.string() + ".damaged";
  problem = file_.string() + ": damaged or of another version; kept aside as " + aside +
            "; counts and operators' orders begin anew";
  if (::rename(file_.c_str(), aside.c_str()) != 0) problem = why(file_);
  return {};
}

std::string FileStateStore::save(const SavedState& state) {
  const std::string fresh = file_.string() + ".new";
  const int fd = ::open(fresh.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) return why(fresh);
  const bool written = write_all(fd, encode(state)) && ::fsync(fd) == 0;
  std::string text = written ? "" : why(fresh);
  ::close(fd);
  if (!written) {
    ::unlink(fresh.c_str());
    return text;
  }
  if (::rename(fresh.c_str(), file_.c_str()) != 0) return why(file_);
  sync_folder(file_.parent_path());
  return {};
}

}  // namespace stationd::supervisor

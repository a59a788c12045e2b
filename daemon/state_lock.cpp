#include "daemon/state_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace stationd {

StateLock::StateLock(const std::filesystem::path& directory, const std::string& controller)
    : path_(directory / (controller + ".lock")) {
  std::error_code ignored;  // open() says what is wrong
  std::filesystem::create_directories(directory, ignored);
  descriptor_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0640);
  if (descriptor_ < 0)
    error_ = std::strerror(errno);
  else
    held_by_other_ = flock(descriptor_, LOCK_EX | LOCK_NB) != 0;
}

StateLock::~StateLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace stationd

#include "supervisor/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace stationd::supervisor {
namespace {

/// A terminal that is gone is no reason to stop supervising: errors are passed over.
void put(int fd, const std::string& text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const ssize_t n = ::write(fd, text.data() + at, text.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;
    at += static_cast<std::size_t>(n);
  }
}

}  // namespace

bool Terminal::usable() const {
  const char* kind = std::getenv("TERM");
  return ::isatty(fd_) == 1 && kind != nullptr && std::strcmp(kind, "dumb") != 0 && *kind != '\0';
}

Terminal::Size Terminal::size() const {
  winsize size{};
  if (::ioctl(fd_, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {};
  return {size.ws_col, size.ws_row};
}

void Terminal::enter() {
  entered_ = true;
  // Keys would be echoed into the view. In the background that call would stop the process.
  if (::tcgetpgrp(fd_) == ::getpgrp() && ::tcgetattr(fd_, &before_) == 0) {
    termios quiet = before_;
    quiet.c_lflag &= ~static_cast<tcflag_t>(ECHO | ICANON);
    quiet_ = ::tcsetattr(fd_, TCSANOW, &quiet) == 0;
  }
  put(fd_, "\x1b[?1049h\x1b[?25l\x1b[2J");
}

void Terminal::show(const std::vector<std::string>& lines) {
  if (!entered_) enter();
  const Size now = size();
  std::string out = "\x1b[?7l\x1b[H";  // a line that is too wide after a resize must not wrap
  if (now.width != last_.width || now.height != last_.height) out += "\x1b[2J";
  last_ = now;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i != 0) out += "\r\n";
    out += lines[i] + "\x1b[K";
  }
  out += "\x1b[J\x1b[?7h";
  put(fd_, out);
}

void Terminal::leave() {
  if (!entered_) return;
  entered_ = false;
  put(fd_, "\x1b[?25h\x1b[?1049l");
  if (quiet_) ::tcsetattr(fd_, TCSAFLUSH, &before_);
  quiet_ = false;
}

}  // namespace stationd::supervisor

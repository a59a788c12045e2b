// Terminal: shows a view that replaces itself, on its own screen, without flicker; restores the terminal.
// Owned by the application.
// The application's main thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <termios.h>

namespace stationd::supervisor {

class Terminal {
 public:
  /// `fd` is standard output. Nothing is touched until the first show().
  explicit Terminal(int fd) : fd_(fd) {}
  ~Terminal() { leave(); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// A terminal that can move its cursor.
  bool usable() const;
  struct Size {
    std::size_t width = 80;
    std::size_t height = 24;
  };
  /// Asked anew each time, so that a resize is followed.
  Size size() const;
  /// Replaces what is shown; one write.
  void show(const std::vector<std::string>& lines);
  /// Back to the screen that was there before.
  void leave();

 private:
  void enter();

  int fd_;
  bool entered_ = false;
  bool quiet_ = false;  ///< echo was switched off
  Size last_;
  termios before_{};
};

}  // namespace stationd::supervisor

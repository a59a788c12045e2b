#include "supervisor/screen.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <utility>

#include "supervisor/live.hpp"
#include "supervisor/terminal.hpp"

namespace stationd::supervisor {
namespace {

void print_lines(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

/// Lines for a log. With `live`, also the cell's state in one line, once a second while it changes.
class LineScreen final : public Screen {
 public:
  explicit LineScreen(bool live) : live_(live) {}
  void notes(const std::vector<std::string>& lines) override { print_lines(lines); }
  void update(const Model& model, std::int64_t now_ns) override {
    if (!live_ || now_ns - shown_ns_ < 1'000'000'000) return;
    shown_ns_ = now_ns;
    std::string line = one_line(model, now_ns);
    if (line != last_) print_lines({line});
    last_ = std::move(line);
  }
  void close() override {}

 private:
  bool live_;
  std::int64_t shown_ns_ = 0;
  std::string last_;
};

/// The view in a terminal, four times a second.
class LiveScreen final : public Screen {
 public:
  explicit LiveScreen(std::string title) : terminal_(STDOUT_FILENO), title_(std::move(title)) {}
  bool usable() const { return terminal_.usable(); }
  void notes(const std::vector<std::string>& lines) override {
    if (closed_) print_lines(lines);
  }
  void update(const Model& model, std::int64_t now_ns) override {
    if (shown_ns_ != 0 && now_ns - shown_ns_ < 250'000'000) return;
    shown_ns_ = now_ns;
    const Terminal::Size size = terminal_.size();
    ViewOptions options;
    options.width = size.width > 1 ? size.width - 1 : 1;  // erasing behind a full line would take its end
    options.height = size.height;
    options.color = std::getenv("NO_COLOR") == nullptr;
    options.title = title_;
    terminal_.show(render(model, now_ns, options));
  }
  void close() override {
    closed_ = true;
    terminal_.leave();
  }

 private:
  Terminal terminal_;
  std::string title_;
  std::int64_t shown_ns_ = 0;
  bool closed_ = false;
};

}  // namespace

std::unique_ptr<Screen> make_screen(bool live, std::string title) {
  if (live) {
    auto screen = std::make_unique<LiveScreen>(std::move(title));
    if (screen->usable()) return screen;
  }
  return std::make_unique<LineScreen>(live);
}

}  // namespace stationd::supervisor

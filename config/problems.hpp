// Problems: gathers every error of one file, so that they are told at once.
// Owned by the loading function.
// Set-up only; one thread.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "config/config.hpp"

namespace stationd::config {

class Problems {
 public:
  explicit Problems(std::filesystem::path file) : file_(std::move(file)) {}

  void add(Position position, std::string_view key, std::string_view text) {
    list_.push_back({position, message(file_, position, key, text)});
  }
  bool empty() const noexcept { return list_.empty(); }
  const std::filesystem::path& file() const noexcept { return file_; }
  /// All of them in the order of the file; leaves none.
  std::vector<Problem> take();

 private:
  std::filesystem::path file_;
  std::vector<Problem> list_;
};

}  // namespace stationd::config

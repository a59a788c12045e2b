#include "config/problems.hpp"

#include <algorithm>
#include <tuple>

namespace stationd::config {

std::vector<Problem> Problems::take() {
  std::stable_sort(list_.begin(), list_.end(), [](const Problem& a, const Problem& b) {
    return std::tie(a.position.line, a.position.column) < std::tie(b.position.line, b.position.column);
  });
  return std::exchange(list_, {});
}

std::string message(const std::filesystem::path& file, Position position, std::string_view key,
                    std::string_view text) {
  std::string out = file.string();
  if (position.line != 0) out += ":" + std::to_string(position.line) + ":" + std::to_string(position.column);
  out += ": ";
  if (!key.empty()) out.append(key).append(": ");
  // Whatever the file holds, a message stays one line of text.
  for (const char c : text) out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return out;
}

}  // namespace stationd::config

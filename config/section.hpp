// Section: reads one table of a file by its key table; what is wrong becomes a problem, nothing throws.
// Owned by the loading function, on its stack.
// Set-up only; one thread.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "config/keys.hpp"
#include "config/node.hpp"
#include "config/problems.hpp"
#include "config/units.hpp"

namespace stationd::config {

struct DurationRange {
  std::int64_t min_ns;
  std::int64_t max_ns;
};

class Section {
 public:
  /// `path` opens the key in messages: "device.remote-io-1". Unknown keys are reported here.
  Section(const Node& table, const SectionKeys& keys, std::string path, Problems& problems);

  const Node& node() const noexcept { return table_; }
  const std::string& path() const noexcept { return path_; }
  Problems& problems() const noexcept { return problems_; }
  bool has(std::string_view key) const { return member(key) != nullptr; }
  /// Where the key's value stands; the section's own place when it is not there.
  Position position(std::string_view key) const;
  const Member* member(std::string_view key) const;
  void problem(std::string_view key, std::string_view text) const;
  void problem_at(Position position, std::string_view key, std::string_view text) const;

  // Each leaves `out` alone when the key is missing (a missing required key is reported) or wrong (reported).
  // True: `out` has the file's value.
  bool text(std::string_view key, std::string& out) const;
  bool name(std::string_view key, std::string& out) const;  ///< letters, digits, - and _
  bool boolean(std::string_view key, bool& out) const;
  bool duration(std::string_view key, std::int64_t& out_ns, DurationRange range) const;
  bool size(std::string_view key, std::size_t& out_bytes, std::int64_t min, std::int64_t max) const;
  bool number(std::string_view key, double& out, double min, double max) const;
  bool absolute_path(std::string_view key, std::filesystem::path& out) const;
  template <class T> bool integer(std::string_view key, T& out, std::int64_t min, std::int64_t max) const {
    std::int64_t value = 0;
    if (!integer64(key, value, min, max)) return false;
    out = static_cast<T>(value);
    return true;
  }
  template <class E, std::size_t N>
  bool choice(std::string_view key, E& out,
              const std::array<std::pair<std::string_view, E>, N>& choices) const {
    std::array<std::string_view, N> names;
    for (std::size_t i = 0; i < N; ++i) names[i] = choices[i].first;
    const std::size_t index = choice_index(key, names);
    if (index >= N) return false;
    out = choices[index].second;
    return true;
  }

 private:
  const Member* present(std::string_view key) const;
  bool integer64(std::string_view key, std::int64_t& out, std::int64_t min, std::int64_t max) const;
  std::size_t choice_index(std::string_view key, std::span<const std::string_view> names) const;
  void report_unknown() const;

  const Node& table_;
  const SectionKeys& keys_;
  std::string path_;
  Problems& problems_;
};

}  // namespace stationd::config

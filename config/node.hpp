// Node: a file as a plain tree with positions, environment variables expanded; toml++ stays behind it.
// Owned by the loading function.
// Set-up only; one thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/problems.hpp"

namespace stationd::config {

struct Member;

struct Node {
  enum class Kind : std::uint8_t { table, array, string, integer, number, boolean, other };
  Kind kind = Kind::table;
  Position position;
  std::string text;       ///< string: after expansion
  bool expanded = false;  ///< string: it held ${...}, so it may stand for a number or a boolean
  std::int64_t integer = 0;
  double number = 0;
  bool boolean = false;
  std::vector<Member> members;  ///< table, in the order of the file
  std::vector<Node> items;      ///< array

  const Member* find(std::string_view key) const;
};

struct Member {
  std::string key;
  Position position;  ///< of the key
  Node value;
};

/// The file's tree; a file that is no TOML gives one problem and an empty table.
Node parse_toml(std::string_view text, Problems& problems);

/// What a node is, for "found ...": `the text "abc"`, `the number 5`, `a table`.
std::string describe(const Node& node);

}  // namespace stationd::config

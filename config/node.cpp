#include "config/node.hpp"

#include <algorithm>
#include <tuple>

#include <toml++/toml.h>

#include "config/expand.hpp"
#include "config/syntax.hpp"

namespace stationd::config {
namespace {

Position position_of(const toml::source_region& region) {
  return {static_cast<std::uint32_t>(region.begin.line), static_cast<std::uint32_t>(region.begin.column)};
}

Node convert(const toml::node& from, std::string_view key, Problems& problems);

void convert_members(const toml::table& from, Node& to, Problems& problems) {
  for (const auto& [key, value] : from)
    to.members.push_back(
        {std::string(key.str()), position_of(key.source()), convert(value, key.str(), problems)});
  // toml++ sorts by key; the order of the file means something to people, and to stations of one task.
  std::stable_sort(to.members.begin(), to.members.end(), [](const Member& a, const Member& b) {
    return std::tie(a.position.line, a.position.column) < std::tie(b.position.line, b.position.column);
  });
}

void convert_string(const std::string& from, Node& to, std::string_view key, Problems& problems) {
  to.kind = Node::Kind::string;
  Expansion expansion = expand_environment(from);
  if (!expansion.error.empty()) problems.add(to.position, key, expansion.error);
  to.text = std::move(expansion.text);
  to.expanded = expansion.expanded;
}

Node convert(const toml::node& from, std::string_view key, Problems& problems) {
  Node to;
  to.position = position_of(from.source());
  switch (from.type()) {
    case toml::node_type::table:
      to.kind = Node::Kind::table;
      convert_members(*from.as_table(), to, problems);
      break;
    case toml::node_type::array:
      to.kind = Node::Kind::array;
      for (const toml::node& item : *from.as_array()) to.items.push_back(convert(item, key, problems));
      break;
    case toml::node_type::string: convert_string(from.as_string()->get(), to, key, problems); break;
    case toml::node_type::integer:
      to.kind = Node::Kind::integer;
      to.integer = from.as_integer()->get();
      break;
    case toml::node_type::floating_point:
      to.kind = Node::Kind::number;
      to.number = from.as_floating_point()->get();
      break;
    case toml::node_type::boolean:
      to.kind = Node::Kind::boolean;
      to.boolean = from.as_boolean()->get();
      break;
    default: to.kind = Node::Kind::other; break;
  }
  return to;
}

}  // namespace

const Member* Node::find(std::string_view key) const {
  for (const Member& member : members)
    if (member.key == key) return &member;
  return nullptr;
}

Node parse_toml(std::string_view text, Problems& problems) {
  Node root;
  try {
    const toml::table table = toml::parse(text);
    convert_members(table, root, problems);
  } catch (const toml::parse_error& error) {
    const Position at = position_of(error.source());
    problems.add(at, {}, syntax_error_text(text, at, error.description()));
  }
  return root;
}

std::string describe(const Node& node) {
  switch (node.kind) {
    case Node::Kind::table: return "a table";
    case Node::Kind::array: return "a list";
    case Node::Kind::string: return "the text \"" + node.text + "\"";
    case Node::Kind::integer: return "the number " + std::to_string(node.integer);
    case Node::Kind::number: return "the number " + std::to_string(node.number);
    case Node::Kind::boolean: return node.boolean ? "true" : "false";
    case Node::Kind::other: break;
  }
  return "a date or time";
}

}  // namespace stationd::config

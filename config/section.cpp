#include "config/section.hpp"

#include <algorithm>
#include <cassert>

namespace stationd::config {
namespace {

std::string found(const Node& node) { return "found " + describe(node) + "; "; }

std::string join(std::span<const std::string_view> words) {
  std::string out;
  for (const std::string_view word : words) out += (out.empty() ? "\"" : ", \"") + std::string(word) + "\"";
  return out;
}

}  // namespace

Section::Section(const Node& table, const SectionKeys& keys, std::string path, Problems& problems)
    : table_(table), keys_(keys), path_(std::move(path)), problems_(problems) {
  if (!keys_.free_keys) report_unknown();
}

void Section::report_unknown() const {
  std::vector<std::string_view> names;
  for (const Key& key : keys_.keys) names.push_back(key.name);
  for (const Member& given : table_.members) {
    if (std::find(names.begin(), names.end(), given.key) != names.end()) continue;
    std::string text = "unknown key" + suggestion(given.key, names);
    if (nearest(given.key, names).empty())
      text += "; allowed in " + std::string(keys_.heading) + " are " + join(names);
    problem_at(given.position, given.key, text);
  }
}

const Member* Section::member(std::string_view key) const { return table_.find(key); }

const Member* Section::present(std::string_view key) const {
  const auto known =
      std::find_if(keys_.keys.begin(), keys_.keys.end(), [&](const Key& k) { return k.name == key; });
  assert(known != keys_.keys.end() && "a key that is read must be in the key table");
  const Member* given = member(key);
  if (given == nullptr && known->fallback.empty())
    problem_at(table_.position, key, "missing; required is: " + std::string(known->about));
  return given;
}

Position Section::position(std::string_view key) const {
  const Member* given = member(key);
  return given != nullptr ? given->value.position : table_.position;
}

void Section::problem(std::string_view key, std::string_view text) const {
  problem_at(position(key), key, text);
}

void Section::problem_at(Position position, std::string_view key, std::string_view text) const {
  problems_.add(position, path_ + (key.empty() ? "" : ".") + std::string(key), text);
}

bool Section::text(std::string_view key, std::string& out) const {
  const Member* given = present(key);
  if (given == nullptr) return false;
  if (given->value.kind != Node::Kind::string) {
    problem(key, found(given->value) + "allowed is text in quotation marks");
    return false;
  }
  out = given->value.text;
  return true;
}

bool Section::name(std::string_view key, std::string& out) const {
  std::string value;
  if (!text(key, value)) return false;
  if (!is_name(value)) {
    problem(key, "found \"" + value + "\"; allowed are letters, digits, - and _, at least 1 and at most 64");
    return false;
  }
  out = std::move(value);
  return true;
}

bool Section::absolute_path(std::string_view key, std::filesystem::path& out) const {
  std::string value;
  if (!text(key, value)) return false;
  if (value.empty() || value.front() != '/' || value.find('\0') != std::string::npos) {
    problem(key, "found \"" + value + "\"; allowed is an absolute path, as in \"/var/lib/stationd\"");
    return false;
  }
  out = value;
  return true;
}

bool Section::boolean(std::string_view key, bool& out) const {
  const Member* given = present(key);
  if (given == nullptr) return false;
  const Node& value = given->value;
  if (value.kind == Node::Kind::boolean) {
    out = value.boolean;
    return true;
  }
  if (value.kind == Node::Kind::string && value.expanded && (value.text == "true" || value.text == "false")) {
    out = value.text == "true";
    return true;
  }
  problem(key, found(value) + "allowed is true or false, without quotation marks");
  return false;
}

bool Section::integer64(std::string_view key, std::int64_t& out, std::int64_t min, std::int64_t max) const {
  const Member* given = present(key);
  if (given == nullptr) return false;
  const Node& value = given->value;
  std::optional<std::int64_t> number;
  if (value.kind == Node::Kind::integer) number = value.integer;
  if (value.kind == Node::Kind::string && value.expanded) number = parse_integer(value.text);
  if (!number || *number < min || *number > max) {
    const bool open = max == std::numeric_limits<std::int64_t>::max();
    problem(key, found(value) + "allowed is a whole number " +
                     (open ? "from " + std::to_string(min) + " up"
                           : "from " + std::to_string(min) + " to " + std::to_string(max)));
    return false;
  }
  out = *number;
  return true;
}

bool Section::number(std::string_view key, double& out, double min, double max) const {
  const Member* given = present(key);
  if (given == nullptr) return false;
  const Node& value = given->value;
  std::optional<double> number;
  if (value.kind == Node::Kind::integer) number = static_cast<double>(value.integer);
  if (value.kind == Node::Kind::number) number = value.number;
  if (value.kind == Node::Kind::string && value.expanded) number = parse_number(value.text);
  if (!number || !(*number >= min && *number <= max)) {
    std::string range = std::to_string(min);
    range.erase(range.find_last_not_of('0') + 1);
    problem(key, found(value) + "allowed is a number from " + range + " to " +
                     std::to_string(static_cast<std::int64_t>(max)));
    return false;
  }
  out = *number;
  return true;
}

bool Section::duration(std::string_view key, std::int64_t& out_ns, DurationRange range) const {
  const Member* given = present(key);
  if (given == nullptr) return false;
  const Node& value = given->value;
  const std::string allowed = "allowed is " + duration_text(range.min_ns) + " to " +
                              duration_text(range.max_ns) + ", with its unit, as in \"" +
                              duration_text(std::max(range.min_ns, out_ns)) + "\"";
  const auto ns = value.kind == Node::Kind::string ? parse_duration_ns(value.text) : std::nullopt;
  if (!ns) {
    problem(key, found(value) + "not a duration; " + allowed);
    return false;
  }
  if (*ns < range.min_ns || *ns > range.max_ns) {
    problem(key, found(value) + allowed);
    return false;
  }
  out_ns = *ns;
  return true;
}

bool Section::size(std::string_view key, std::size_t& out_bytes, std::int64_t min, std::int64_t max) const {
  const Member* given = present(key);
  if (given == nullptr) return false;
  const auto bytes =
      given->value.kind == Node::Kind::string ? parse_size_bytes(given->value.text) : std::nullopt;
  if (!bytes || *bytes < min || *bytes > max) {
    problem(key, found(given->value) + "allowed is " + size_text(min) + " to " + size_text(max) +
                     ", with its unit, as in \"8KiB\"");
    return false;
  }
  out_bytes = static_cast<std::size_t>(*bytes);
  return true;
}

std::size_t Section::choice_index(std::string_view key, std::span<const std::string_view> names) const {
  const Member* given = present(key);
  if (given == nullptr) return names.size();
  const Node& value = given->value;
  if (value.kind == Node::Kind::string) {
    const auto it = std::find(names.begin(), names.end(), value.text);
    if (it != names.end()) return static_cast<std::size_t>(it - names.begin());
  }
  problem(key, found(value) + "allowed are " + join(names) +
                   (value.kind == Node::Kind::string ? suggestion(value.text, names) : std::string()));
  return names.size();
}

}  // namespace stationd::config

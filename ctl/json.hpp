// Json: writes one JSON value, member by member, in the order of the calls.
// Owned by whoever prints it.
// One thread.
#pragma once

#include <concepts>
#include <string>
#include <string_view>
#include <vector>

namespace stationd::ctl {

/// A JSON string with its quotes. Bytes that are not UTF-8 become U+FFFD: the result is always valid.
std::string json_quoted(std::string_view text);

/// "[a,b]" of values that are JSON already.
std::string json_array(const std::vector<std::string>& values);

class JsonObject {
 public:
  JsonObject& text(std::string_view key, std::string_view value) { return raw(key, json_quoted(value)); }
  JsonObject& flag(std::string_view key, bool value) { return raw(key, value ? "true" : "false"); }
  template <std::integral T>
  requires(!std::same_as<T, bool>) JsonObject& number(std::string_view key, T value) {
    return raw(key, std::to_string(value));
  }
  /// `value` is JSON already.
  JsonObject& raw(std::string_view key, std::string_view value);
  std::string str() const { return body_.empty() ? "{}" : body_ + "}"; }

 private:
  std::string body_;
};

}  // namespace stationd::ctl

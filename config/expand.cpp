#include "config/expand.hpp"

#include <cstdlib>

namespace stationd::config {
namespace {

bool is_variable_name(std::string_view name) {
  if (name.empty() || (name.front() >= '0' && name.front() <= '9')) return false;
  for (const char c : name)
    if (!((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'))
      return false;
  return true;
}

/// `body`: what stands between the braces.
void expand_one(std::string_view body, Expansion& out) {
  const std::size_t split = body.find(":-");
  const std::string name(body.substr(0, split));
  if (!is_variable_name(name)) {
    out.error = "found ${" + std::string(body) + "}; allowed is ${NAME} or ${NAME:-default}";
    return;
  }
  const char* value = std::getenv(name.c_str());
  if (value != nullptr && *value != '\0') {
    out.text += value;
  } else if (split != std::string_view::npos) {
    out.text += body.substr(split + 2);
  } else {
    out.error =
        "the environment variable " + name + " is not set; ${" + name + ":-default} gives it a default";
  }
  out.expanded = true;
}

}  // namespace

Expansion expand_environment(std::string_view text) {
  Expansion out;
  std::size_t at = 0;
  while (at < text.size() && out.error.empty()) {
    if (text.substr(at, 3) == "$${") {
      out.text += "${";
      at += 3;
    } else if (text.substr(at, 2) == "${") {
      const std::size_t end = text.find('}', at);
      if (end == std::string_view::npos) {
        out.error = "found ${ without a closing }; allowed is ${NAME:-default}, and $${ for a plain ${";
        break;
      }
      expand_one(text.substr(at + 2, end - at - 2), out);
      at = end + 1;
    } else {
      out.text += text[at++];
    }
  }
  return out;
}

}  // namespace stationd::config

#include "config/keys.hpp"
#include "config/loading.hpp"

namespace stationd::config {
namespace {

constexpr std::string_view kIntroduction = R"(# Configuration: every section and key

This page is made from the tables that the daemon itself reads files by; a test holds the two equal.

One TOML file per controller, `stationd FILE`; `stationd --check FILE` only checks it. A key that is not
listed here is an error. All errors are told at once, each with file, line, column, key, what was found and
what is allowed; the exit status is then 78. Examples: `config/controller1.toml`, `config/controller2.toml`,
`config/cell-in-process.toml`, `config/supervisor.toml`.

- **Durations** carry a unit: `"250us"`, `"10ms"`, `"1.5s"`, `"2min"`, `"1h"`. **Sizes** too: `"512B"`,
  `"8KiB"`.
- **Environment variables** in any text: `"${NAME:-default}"`, and `"${NAME}"` where the variable must be set;
  an empty variable counts as not set. `"$${"` stands for a plain `${`. Where a number, `true` or `false` is
  asked for, such a text may stand for it: `domain = "${STATIOND_DOMAIN:-0}"`.
- **Addresses** of Modbus tables are those of the protocol, counted from 0. Numbers of the 40001 kind are
  refused with the address that is meant.
)";

/// A cell of a table: `|` would end it.
std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

void append_sections(std::string& out, std::span<const SectionKeys* const> sections) {
  for (const SectionKeys* section : sections) {
    out += "\n### `" + std::string(section->heading) + "`\n" + std::string(section->about) + "\n\n";
    out += "| key | kind | default | meaning |\n| --- | --- | --- | --- |\n";
    for (const Key& key : section->keys)
      out += "| `" + std::string(key.name) + "` | " + cell(key.kind) + " | " +
             (key.fallback.empty() ? std::string("**required**") : cell(key.fallback)) + " | " +
             cell(key.about) + " |\n";
  }
}

}  // namespace

std::string reference_markdown() {
  std::string out(kIntroduction);
  out += "\n## A controller's file\n";
  append_sections(out, controller_sections());
  out +=
      "\n## A supervisor's file\n`[log]` and `[bus]` are as above, without `heartbeat`, `stale_after` and "
      "`bad_after`.\n";
  append_sections(out, supervisor_sections().first(1));
  return out;
}

}  // namespace stationd::config

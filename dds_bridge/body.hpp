// Body: what the BODY of a request says: `verb argument... key=value... [from=NAME] [id=N]`.
// Owned by the caller; no state of its own.
// Any thread.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stationd::bus {

struct Body {
  std::vector<std::string> words;                          ///< verb and arguments, in order
  std::vector<std::pair<std::string, std::string>> pairs;  ///< key=value but from and id, in order
  std::string from;                                        ///< who asks; empty if not said
  std::string id;                                          ///< to be repeated in the reply; empty if not said
  std::string problem;  ///< why the body is refused, for people; empty: it is well formed
  bool ok() const noexcept { return problem.empty(); }
};

/// Never throws for any content. With a problem, `from` and `id` are still what could be made out, for the
/// answer.
/// Refused: longer than `max_bytes`, not UTF-8, control characters, an empty key, a key given twice, a name
/// in `from` over 255 bytes or an `id` over 64. Words are separated by blanks, tabs or line ends.
Body parse_body(std::string_view text, std::size_t max_bytes);

/// The beginning of a reply's BODY: "id=7 ", or nothing.
std::string reply_prefix(const Body& body);

/// At most `max_bytes` of the text, cut between two UTF-8 characters.
std::string clipped(std::string_view text, std::size_t max_bytes);

}  // namespace stationd::bus

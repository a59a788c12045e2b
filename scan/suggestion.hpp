// Suggestion: which of the known names was probably meant.
// Owned by nobody (pure functions).
// Any plain thread (they allocate).
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace stationd {

/// The one of `known` that `word` is most likely a misspelling of; empty: none is near.
std::string_view nearest(std::string_view word, std::span<const std::string_view> known);
/// "; did you mean \"...\"?" or nothing.
std::string suggestion(std::string_view word, std::span<const std::string_view> known);

}  // namespace stationd

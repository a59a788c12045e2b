// Screens: a view that replaces itself in a terminal, and plain lines elsewhere.
// Owned by main().
// The application's main thread.
#pragma once

#include <memory>
#include <string>

#include "supervisor/application.hpp"

namespace stationd::supervisor {

/// `live`: the terminal's view where standard output is one (else a line a second while something changes).
std::unique_ptr<Screen> make_screen(bool live, std::string title);

}  // namespace stationd::supervisor

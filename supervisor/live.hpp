// Live: the cell as text, made from the model alone.
// Owned by nobody (pure functions); the terminal (terminal.hpp) shows it.
// The model's thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "supervisor/model.hpp"

namespace stationd::supervisor {

struct ViewOptions {
  std::size_t width = 100;
  std::size_t height = 0;  ///< lines there are; 0: as many as it takes
  bool color = false;
  std::size_t events = 10;
  std::string title;  ///< "cell assembly, domain 7"
};

/// The lines of the view, none wider than `width` and no more than `height`: header, table, last events,
/// keys.
/// Where the width does not do, columns leave in the order of their importance.
std::vector<std::string> render(const Model& model, std::int64_t now_ns, const ViewOptions& options);

/// One line for a log: "storage RUNNING 12 pieces | sealer RUNNING | robot away".
std::string one_line(const Model& model, std::int64_t now_ns);

/// What was done, when it is over.
std::string summary(const Model& model, std::int64_t now_ns, std::int64_t began_ns);

}  // namespace stationd::supervisor

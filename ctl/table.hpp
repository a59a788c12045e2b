// Table: rows of cells in aligned columns.
// Owned by nobody (pure function).
// Any plain thread (it allocates).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace stationd::ctl {

/// `right`: columns whose numbers stand at the right. No line is wider than `width` (0: any).
std::vector<std::string> aligned(const std::vector<std::vector<std::string>>& rows,
                                 const std::vector<bool>& right, std::size_t width);

}  // namespace stationd::ctl

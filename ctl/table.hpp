// Table: rows of cells in aligned columns.
// Owned by nobody (pure functions).
// Any plain thread (they allocate).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace stationd::ctl {

/// `right`: columns whose numbers stand at the right. No line is wider than `width` (0: any).
std::vector<std::string> aligned(const std::vector<std::vector<std::string>>& rows,
                                 const std::vector<bool>& right, std::size_t width);

struct Column {
  std::string_view heading;
  bool right = false;  ///< numbers stand at the right
  int leaves = 0;      ///< when the table is too wide: 0 never, else the greatest first
};

/// The same under headings, the cells of each row in the order of the columns. Where `width` does not do,
/// columns leave, and what is still too long is cut.
std::vector<std::string> table_lines(std::vector<Column> columns, std::vector<std::vector<std::string>> rows,
                                     std::size_t width);

}  // namespace stationd::ctl

#include "ctl/table.hpp"

#include <algorithm>

#include "dds_bridge/text.hpp"

namespace stationd::ctl {
namespace {

constexpr std::size_t kGap = 2;

std::vector<std::size_t> widths_of(const std::vector<std::vector<std::string>>& rows, std::size_t columns) {
  std::vector<std::size_t> widths(columns, 0);
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], bus::columns_of(row[c]));
  return widths;
}

/// Takes out the columns that there is no room for.
void make_fit(std::vector<Column>& columns, std::vector<std::vector<std::string>>& rows, std::size_t width) {
  for (;;) {
    std::size_t total = 0;
    for (const std::size_t w : widths_of(rows, columns.size())) total += w + kGap;
    if (total <= width + kGap) return;
    const auto leaving = std::ranges::max_element(columns, {}, &Column::leaves);
    if (leaving == columns.end() || leaving->leaves == 0) return;
    const auto at = leaving - columns.begin();
    columns.erase(leaving);
    for (auto& row : rows) row.erase(row.begin() + at);
  }
}

}  // namespace

std::vector<std::string> aligned(const std::vector<std::vector<std::string>>& rows,
                                 const std::vector<bool>& right, std::size_t width) {
  const std::vector<std::size_t> widths = widths_of(rows, right.size());
  std::vector<std::string> lines;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (c != 0) line.append(kGap, ' ');
      line += right[c] ? bus::fit_right(row[c], widths[c]) : bus::fit(row[c], widths[c]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    lines.push_back(width == 0 ? line : bus::cut(line, width));
  }
  return lines;
}

std::vector<std::string> table_lines(std::vector<Column> columns, std::vector<std::vector<std::string>> rows,
                                     std::size_t width) {
  std::vector<std::string> headings;
  for (const Column& column : columns) headings.emplace_back(column.heading);
  rows.insert(rows.begin(), std::move(headings));
  if (width != 0) make_fit(columns, rows, width);
  std::vector<bool> right;
  for (const Column& column : columns) right.push_back(column.right);
  return aligned(rows, right, width);
}

}  // namespace stationd::ctl

#include "supervisor/live.hpp"

#include <algorithm>
#include <array>

#include "dds_bridge/text.hpp"

namespace stationd::supervisor {
namespace {

using bus::code_text;
using bus::columns_of;
using bus::count_text;
using bus::cut;
using bus::fit;
using bus::fit_right;
using bus::printable;
using bus::short_duration;
using bus::state_text;
using bus::step_text;

constexpr std::string_view kGreen = "\x1b[32m", kRed = "\x1b[31m", kYellow = "\x1b[33m", kDim = "\x1b[2m",
                           kBold = "\x1b[1m", kPlain = "\x1b[0m";

/// A column: heading, width, whether numbers stand at its right, and when it leaves a narrow view (0: never,
/// else
/// the greatest first).
struct Column {
  std::string_view heading;
  std::size_t width;
  bool right;
  int leaves;
};

enum : std::size_t {
  kName,
  kController,
  kState,
  kStep,
  kPiece,
  kScans,
  kMisses,
  kLateness,
  kPieces,
  kFault,
  kColumns
};

constexpr std::array<Column, kColumns> kTable{{{"STATION", 10, false, 0},
                                               {"CONTROLLER", 12, false, 5},
                                               {"STATE", 8, false, 0},
                                               {"STEP", 18, false, 3},
                                               {"PIECE", 5, true, 2},
                                               {"SCANS", 10, true, 6},
                                               {"MISSES", 7, true, 4},
                                               {"LATE p99/max", 15, true, 7},
                                               {"PIECES", 7, true, 0},
                                               {"FAULT OR WARNING", 30, false, 1}}};

using Row = std::array<std::string, kColumns>;

std::string painted(std::string text, std::string_view paint, bool color) {
  if (!color || paint.empty()) return text;
  return std::string(paint) + text + std::string(kPlain);
}

std::string_view paint_of(const Model& model, const StationRecord& station, std::int64_t now_ns) {
  if (model.away(station, now_ns)) return kDim;
  if (station.in_state(StationState::RUNNING)) return kGreen;
  return station.in_state(StationState::FAULT) ? kRed : kYellow;
}

/// What stands in the way, or why the station stands still.
std::string remark_of(const StationRecord& station, const bus::Status& status) {
  if (status.FAULT != 0) return code_text(status.FAULT);
  if (status.WARNING != 0) return code_text(status.WARNING);
  if (!station.in_state(StationState::STOPPED)) return "";
  if (station.intent == Intent::stopped) return "stopped by an operator";
  if (station.intent == Intent::faulted) return "reset after a fault: Start it";
  return "";
}

Row row_of(const Model& model, const StationRecord& station, std::int64_t now_ns) {
  Row row;
  row[kName] = printable(station.name);
  row[kPieces] = std::to_string(station.pieces.counted);
  if (station.pieces.missed != 0) row[kPieces] += "+" + std::to_string(station.pieces.missed);
  if (!station.status) {
    row[kState] = "not seen";
    return row;
  }
  const bus::Status& status = *station.status;
  const bool away = model.away(station, now_ns);
  row[kController] = printable(status.CONTROLLER);
  row[kState] = away ? "away" : state_text(status.STATE);
  row[kStep] = step_text(status);
  row[kPiece] = status.PIECE == 0 ? "-" : std::to_string(status.PIECE);
  row[kScans] = std::to_string(status.SCANS);
  row[kMisses] = std::to_string(status.DEADLINE_MISSES);
  row[kLateness] = short_duration(status.LATENESS_P99_NS) + "/" + short_duration(status.LATENESS_MAX_NS);
  row[kFault] =
      away ? "no Status for " + short_duration(now_ns - station.seen_ns) : remark_of(station, status);
  return row;
}

/// Which columns there is room for; the last one takes what is left over.
struct Layout {
  std::array<bool, kColumns> shown{};
  std::array<std::size_t, kColumns> width{};
};

Layout layout_for(std::size_t width, const std::vector<Row>& rows) {
  Layout layout;
  layout.shown.fill(true);
  for (std::size_t c = 0; c < kColumns; ++c) {
    layout.width[c] = kTable[c].width;
    if (c == kName)  // names in full where possible
      for (const Row& row : rows)
        layout.width[c] = std::clamp(columns_of(row[c]), layout.width[c], std::size_t{20});
  }
  const auto total = [&] {
    std::size_t sum = 0;
    for (std::size_t c = 0; c < kColumns; ++c)
      if (layout.shown[c]) sum += layout.width[c] + 1;
    return sum == 0 ? 0 : sum - 1;
  };
  for (int leaves = kColumns; leaves > 0 && total() > width; --leaves)
    for (std::size_t c = 0; c < kColumns; ++c)
      if (kTable[c].leaves == leaves) layout.shown[c] = false;
  if (layout.shown[kFault] && total() < width) layout.width[kFault] += width - total();
  return layout;
}

std::string line_of(const Layout& layout, const Row& row, std::size_t width, std::string_view state_paint,
                    bool color) {
  std::string out;
  std::size_t used = 0;
  for (std::size_t c = 0; c < kColumns; ++c) {
    if (!layout.shown[c]) continue;
    const std::size_t gap = used == 0 ? 0 : 1;
    if (used + gap >= width) break;
    const std::size_t room = std::min(layout.width[c], width - used - gap);
    const std::string cell = kTable[c].right ? fit_right(row[c], room) : fit(row[c], room);
    out.append(gap, ' ');
    out += painted(cell, c == kState ? state_paint : std::string_view{}, color);
    used += gap + room;
  }
  return out;
}

std::string header(const Model& model, std::int64_t now_ns, const ViewOptions& options) {
  std::size_t running = 0;
  for (const StationRecord& s : model.stations())
    if (s.in_state(StationState::RUNNING) && !model.away(s, now_ns)) ++running;
  std::string text =
      printable(model.options().name) + (model.role() == Role::commanding ? "" : " (observing)");
  text += " | " + count_text(model.pieces(), "piece") + " at " + printable(model.count_at());
  text += " | " + std::to_string(running) + " of " + std::to_string(model.stations().size()) + " running";
  if (!options.title.empty()) text += " | " + printable(options.title);
  return painted(cut(text, options.width), kBold, options.color);
}

void append_events(std::vector<std::string>& lines, const Model& model, const ViewOptions& options) {
  const auto& records = model.events().records();
  std::string title = "Last events";
  if (!records.empty()) title += ", times in " + bus::zone_text(records.back().gse.SOURCE_TIME);
  if (model.events().missing() != 0) title += " (" + std::to_string(model.events().missing()) + " lost)";
  lines.push_back(painted(cut(title, options.width), kBold, options.color));
  const std::size_t shown = std::min(options.events, records.size());
  for (std::size_t i = records.size() - shown; i < records.size(); ++i)
    lines.push_back(cut("  " + event_text(records[i]), options.width));
  if (shown == 0) lines.emplace_back(cut("  none", options.width));
}

}  // namespace

std::vector<std::string> render(const Model& model, std::int64_t now_ns, const ViewOptions& options) {
  std::vector<Row> rows;
  for (const StationRecord& station : model.stations()) rows.push_back(row_of(model, station, now_ns));
  const Layout layout = layout_for(options.width, rows);
  Row headings;
  for (std::size_t c = 0; c < kColumns; ++c) headings[c] = kTable[c].heading;

  std::vector<std::string> lines{header(model, now_ns, options), ""};
  lines.push_back(painted(line_of(layout, headings, options.width, {}, false), kDim, options.color));
  for (std::size_t i = 0; i < rows.size(); ++i)
    lines.push_back(
        line_of(layout, rows[i], options.width, paint_of(model, model.stations()[i], now_ns), options.color));
  lines.emplace_back();
  ViewOptions room = options;
  if (options.height != 0) {
    const std::size_t taken = lines.size() + 3;  // title of the events, blank line, keys
    room.events = std::min(options.events, options.height > taken ? options.height - taken : 0);
  }
  append_events(lines, model, room);
  lines.emplace_back();
  lines.push_back(painted(cut("Ctrl-C ends", options.width), kDim, options.color));
  if (options.height != 0 && lines.size() > options.height) lines.resize(options.height);
  return lines;
}

std::string one_line(const Model& model, std::int64_t now_ns) {
  std::string out = count_text(model.pieces(), "piece");
  for (const StationRecord& station : model.stations()) {
    const Row row = row_of(model, station, now_ns);
    out += " | " + row[kName] + " " + row[kState];
    if (station.status && !row[kFault].empty()) out += ": " + row[kFault];
  }
  return out;
}

std::string summary(const Model& model, std::int64_t now_ns, std::int64_t began_ns) {
  std::string out = count_text(model.pieces(), "piece") + " counted at " + printable(model.count_at()) +
                    " in " + short_duration(now_ns - began_ns) + "; " +
                    count_text(model.events().listed(), "event") + ", " +
                    std::to_string(model.events().missing()) + " lost\n";
  for (const StationRecord& station : model.stations()) {
    const PieceCount& count = station.pieces;
    out += "  " + fit(printable(station.name), 10) + " " + count_text(count.counted, "piece");
    if (count.missed != 0) out += ", " + std::to_string(count.missed) + " more finished unseen";
    if (count.faulty != 0) out += ", " + std::to_string(count.faulty) + " with errors";
    if (station.status) {
      out += ", " + count_text(station.status->DEADLINE_MISSES, "deadline miss") + " in ";
      out += count_text(station.status->SCANS, "scan");
    }
    if (station.restarts != 0) out += ", restarted " + count_text(station.restarts, "time");
    out += "\n";
  }
  return out;
}

}  // namespace stationd::supervisor

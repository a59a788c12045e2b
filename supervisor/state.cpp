#include "supervisor/state.hpp"

#include <charconv>
#include <vector>

namespace stationd::supervisor {
namespace {

constexpr std::string_view kFirstLine = "stationd-supervisor 1";
constexpr std::string_view kLastLine = "end";

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const std::size_t at = text.find(separator);
    parts.push_back(text.substr(0, at));
    text.remove_prefix(at == std::string_view::npos ? text.size() : at + 1);
  }
  return parts;
}

template <class T> bool read(std::string_view text, T& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc{} && end == text.data() + text.size();
}

std::optional<Intent> intent_of(std::string_view name) {
  for (const Intent intent : {Intent::run, Intent::stopped, Intent::faulted})
    if (name == name_of(intent)) return intent;
  return std::nullopt;
}

bool read_line(const std::vector<std::string_view>& words, SavedState& state) {
  if (words.size() < 2 || words[1].empty()) return false;
  SavedStation& station = state[std::string(words[1])];
  if (words[0] == "intent" && words.size() == 3) {
    const std::optional<Intent> intent = intent_of(words[2]);
    if (!intent) return false;
    station.intent = *intent;
    return true;
  }
  PieceCount& pieces = station.pieces;
  if (words[0] == "pieces" && words.size() == 5)
    return read(words[2], pieces.counted) && read(words[3], pieces.faulty) && read(words[4], pieces.missed);
  if (words[0] == "plain" && words.size() == 5) {
    int error = 0;
    if (!read(words[2], pieces.plain_code) || !read(words[3], error) || !read(words[4], pieces.plain_status))
      return false;
    pieces.plain_error = error != 0;
    return true;
  }
  EpochCount epoch;
  if (words[0] != "epoch" || words.size() != 4 || pieces.epochs.size() >= PieceCount::kEpochs) return false;
  if (!read(words[2], epoch.epoch) || !read(words[3], epoch.last_seq)) return false;
  pieces.epochs.push_back(epoch);
  return true;
}

void append_line(std::string& out, std::string_view kind, std::string_view station,
                 std::initializer_list<std::string> values) {
  out.append(kind).append(" ").append(station);
  for (const std::string& value : values) out.append(" ").append(value);
  out.append("\n");
}

/// Names with blanks or line ends cannot be written as words; the configuration allows none, the network
/// might.
bool writable(std::string_view name) {
  return !name.empty() && name.find_first_of(std::string_view(" \n\r\t\0", 5)) == std::string_view::npos;
}

}  // namespace

std::string_view name_of(Intent intent) noexcept {
  switch (intent) {
    case Intent::run: return "run";
    case Intent::stopped: return "stopped";
    case Intent::faulted: return "faulted";
  }
  return "run";
}

std::string encode(const SavedState& state) {
  using std::to_string;
  std::string out(kFirstLine);
  out += '\n';
  for (const auto& [name, station] : state) {
    if (!writable(name)) continue;
    const PieceCount& pieces = station.pieces;
    append_line(out, "intent", name, {std::string(name_of(station.intent))});
    append_line(out, "pieces", name,
                {to_string(pieces.counted), to_string(pieces.faulty), to_string(pieces.missed)});
    for (const EpochCount& epoch : pieces.epochs)
      append_line(out, "epoch", name, {to_string(epoch.epoch), to_string(epoch.last_seq)});
    if (pieces.plain_code != 0)
      append_line(
          out, "plain", name,
          {to_string(pieces.plain_code), pieces.plain_error ? "1" : "0", to_string(pieces.plain_status)});
  }
  out.append(kLastLine).append("\n");
  return out;
}

std::optional<SavedState> decode(std::string_view text) {
  const std::vector<std::string_view> lines = split(text, '\n');
  if (lines.size() < 2 || lines.front() != kFirstLine || lines.back() != kLastLine || text.back() != '\n')
    return std::nullopt;
  SavedState state;
  for (std::size_t i = 1; i + 1 < lines.size(); ++i)
    if (!read_line(split(lines[i], ' '), state)) return std::nullopt;
  return state;
}

}  // namespace stationd::supervisor

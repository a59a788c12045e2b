#include "dds_bridge/histogram_body.hpp"

#include <algorithm>
#include <charconv>

namespace stationd::bus {
namespace {

constexpr std::size_t kMostMerged = 4096;  // all in one
static_assert(kMostMerged >= Buckets::kCount);

std::string text_of(const HistogramBody& body) {
  std::string text("figure=");
  text.append(name_of(body.figure)).append(" window=").append(name_of(body.window));
  text += " merged=" + std::to_string(body.merged);
  for (const BucketCount& b : body.buckets)
    text += " " + std::to_string(b.bucket) + ":" + std::to_string(b.count);
  return text;
}

void merge(HistogramBody& body) {
  std::vector<BucketCount> coarse;
  for (const BucketCount& b : body.buckets) {
    if (coarse.empty() || coarse.back().bucket != b.bucket / 2) coarse.push_back({b.bucket / 2, 0});
    coarse.back().count += b.count;
  }
  body.buckets = std::move(coarse);
  body.merged *= 2;
}

template <class T> bool number(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

bool take_bucket(std::string_view word, HistogramBody& body) {
  const std::size_t colon = word.find(':');
  BucketCount b;
  if (!number(word.substr(0, colon), b.bucket) || !number(word.substr(colon + 1), b.count)) return false;
  if (b.bucket * body.merged >= Buckets::kCount || b.bucket >= Buckets::kCount) return false;
  if (!body.buckets.empty() && b.bucket <= body.buckets.back().bucket) return false;
  body.buckets.push_back(b);
  return true;
}

bool take_pair(std::string_view key, std::string_view value, HistogramBody& body) {
  if (key == "figure") {
    const std::optional<Figure> figure = find_figure(value);
    if (figure) body.figure = *figure;
    return figure.has_value();
  }
  if (key == "window") {
    body.window = value == name_of(Window::last_minute) ? Window::last_minute : Window::since_start;
    return value == name_of(body.window);
  }
  if (key != "merged") return true;
  return number(value, body.merged) && body.merged >= 1 && body.merged <= kMostMerged;
}

}  // namespace

std::string histogram_text(HistogramBody body, std::size_t max_bytes) {
  std::string text = text_of(body);
  while (text.size() > max_bytes && body.merged < kMostMerged) {
    merge(body);
    text = text_of(body);
  }
  return text;
}

std::optional<HistogramBody> parse_histogram(std::string_view text) {
  HistogramBody body;
  if (!text.starts_with("figure=")) return std::nullopt;
  while (!text.empty()) {
    const std::size_t blank = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, blank);
    text.remove_prefix(std::min(blank + 1, text.size()));
    const std::size_t equals = word.find('=');
    if (equals != std::string_view::npos) {
      if (!take_pair(word.substr(0, equals), word.substr(equals + 1), body)) return std::nullopt;
    } else if (word.find(':') != std::string_view::npos && !take_bucket(word, body)) {
      return std::nullopt;
    }
  }
  return body;
}

}  // namespace stationd::bus

#include <string>

#include "io/plant/ledger.hpp"

namespace stationd::plant {

namespace {

constexpr std::int64_t kNsPerMs = 1'000'000;
constexpr std::array<std::string_view, 6> kFates = {"in_cell", "right",   "wrong",
                                                    "removed", "dropped", "unstored"};

/// Builds one JSON text; keys and strings here are our own plain words and need no escapes.
class Json {
 public:
  void open(char bracket) {
    separate();
    text_ += bracket;
    first_ = true;
  }
  void close(char bracket) {
    text_ += bracket;
    first_ = false;
  }
  void key(std::string_view name) {
    separate();
    (text_ += '"').append(name).append("\": ");
    first_ = true;
  }
  void raw(std::string_view value) {
    separate();
    text_ += value;
  }
  void number(std::string_view name, std::uint64_t value) { key(name), raw(std::to_string(value)); }
  void word(std::string_view name, std::string_view value) {
    key(name);
    raw(std::string(1, '"').append(value).append(1, '"'));
  }
  void time(std::string_view name, std::int64_t at_ns) {
    key(name);
    raw(at_ns < 0 ? "null" : std::to_string(at_ns / kNsPerMs));
  }
  /// Whether list members go on lines of their own.
  void break_lines(bool broken) { broken_ = broken; }
  std::string take() { return std::move(text_); }

 private:
  void separate() {
    if (!first_) text_ += broken_ ? ",\n" : ", ";
    first_ = false;
  }
  std::string text_;
  bool first_ = true;
  bool broken_ = false;
};

void write_verdict(Json& json, const Verdict& v) {
  json.key("verdict");
  json.open('{');
  json.number("pallets", v.pallets);
  json.number("in_cell", v.in_cell);
  json.number("stored", v.stored);
  json.number("stored_right", v.stored_right);
  json.number("stored_wrong", v.stored_wrong);
  json.number("stored_twice", v.stored_twice);
  json.number("wrong_parts", v.wrong_parts);
  json.number("missing_parts", v.missing_parts);
  json.number("doubles", v.doubles);
  json.number("unseated", v.unseated);
  json.number("wrong_shelf", v.wrong_shelf);
  json.number("left_unstored", v.left_unstored);
  json.number("removed", v.removed);
  json.number("dropped_parts", v.dropped_parts);
  json.number("dropped_pieces", v.dropped_pieces);
  json.number("parts_removed", v.parts_removed);
  json.number("violations", v.violations);
  json.key("clean");
  json.raw(v.clean() ? "true" : "false");
  json.close('}');
}

void write_violations(Json& json, const Ledger& ledger) {
  json.key("violations_by_kind");
  json.open('{');
  for (std::size_t i = 0; i < kViolationKinds; ++i) {
    const auto kind = static_cast<ViolationKind>(i);
    json.number(name_of(kind), ledger.count(kind));
  }
  json.close('}');
  json.key("violations");
  json.open('[');
  for (const Violation& violation : ledger.violations()) {
    json.open('{');
    json.time("at_ms", violation.at_ns);
    json.number("unit", static_cast<std::uint64_t>(violation.unit));
    json.word("kind", name_of(violation.kind));
    json.number("pallet", violation.pallet);
    json.close('}');
  }
  json.close(']');
}

void write_pallet(Json& json, const PalletRecord& record, Fate fate) {
  json.open('{');
  json.break_lines(false);
  json.number("number", record.number);
  json.number("code", record.code);
  json.time("entered_ms", record.entered_ns);
  json.key("parts");
  json.open('[');
  for (std::size_t part = 0; part < kParts; ++part) {
    if (record.variant[part] == 0) continue;
    json.open('{');
    json.word("part", name_of(static_cast<Part>(part)));
    json.number("variant", record.variant[part]);
    json.time("at_ms", record.placed_ns[part]);
    json.close('}');
  }
  json.close(']');
  json.number("doubles", record.doubles);
  json.time("seated_ms", record.seated_ns);
  json.time("picked_ms", record.picked_ns);
  json.time("stored_ms", record.stored_ns);
  json.number("times_stored", record.times_stored);
  json.number("shelf", record.shelf);
  json.time("removed_ms", record.removed_ns);
  json.time("dropped_ms", record.dropped_ns);
  json.time("left_ms", record.left_ns);
  json.word("fate", kFates[static_cast<std::size_t>(fate)]);
  json.close('}');
}

}  // namespace

std::string Ledger::to_json(std::int64_t now_ns, bool final) const {
  Json json;
  json.open('{');
  json.time("time_ms", now_ns);
  json.key("final");
  json.raw(final ? "true" : "false");
  write_verdict(json, verdict());
  write_violations(json, *this);
  json.key("pallets");
  json.open('[');
  for (const PalletRecord& record : pallets_) {
    json.break_lines(true);
    write_pallet(json, record, fate_of(record));
  }
  json.close(']');
  json.close('}');
  return json.take() + '\n';
}

}  // namespace stationd::plant

#include "dds_bridge/tag_orders.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "dds_bridge/values.hpp"
#include "scan/codes.hpp"
#include "scan/forces.hpp"
#include "scan/suggestion.hpp"

namespace stationd::bus {
namespace {

/// The names that the order may have meant.
template <class Wanted> std::string hint(const Image& image, std::string_view name, const Wanted& wanted) {
  std::vector<std::string_view> names;
  for (TagIndex tag = 0; tag < image.size(); ++tag)
    if (wanted(image.spec(tag))) names.push_back(image.spec(tag).name);
  return suggestion(name, names);
}

CheckedOrder refused(std::uint32_t code, std::string problem) { return {{}, code, std::move(problem)}; }

/// Sets request.tag; refused if there is no such tag.
template <class Wanted>
CheckedOrder with_tag(const Image& image, Verb verb, const std::string& name, const Wanted& wanted) {
  const auto tag = image.find(name);
  if (!tag) return refused(code::unknown_tag, "there is no tag " + name + hint(image, name, wanted));
  CheckedOrder order;
  order.request.verb = verb;
  order.request.tag = *tag;
  return order;
}

bool any(const TagSpec&) { return true; }

std::string area_text(const TagSpec& spec) {
  if (spec.parameter) return "a parameter";
  return (spec.area == Area::retained ? "a " : "an ") + std::string(name_of(spec.area)) + " tag";
}

/// Sets request.value from the text.
CheckedOrder with_value(const Image& image, CheckedOrder order, const std::string& text) {
  const TagSpec& spec = image.spec(order.request.tag);
  const ParsedValue value = parse_value(spec, text);
  if (!value.problem.empty()) return refused(code::value_invalid, spec.name + ": " + value.problem);
  order.request.value = value.slot;
  return order;
}

CheckedOrder check_force(const Image& image, const Body& body) {
  if (body.words.size() != 3) return refused(code::body_invalid, "force takes a tag and a value");
  CheckedOrder order = with_tag(image, Verb::force, body.words[1], forceable);
  if (order.refusal != 0) return order;
  const TagSpec& spec = image.spec(order.request.tag);
  if (spec.type == TagType::STRING)
    return refused(code::not_forceable, spec.name + " is a STRING, which cannot be forced");
  if (!forceable(spec))
    return refused(code::not_forceable, spec.name + " is " + area_text(spec) +
                                            ": inputs and outputs are forced" +
                                            (spec.writable ? "; it can be set" : ""));
  return with_value(image, order, body.words[2]);
}

CheckedOrder check_unforce(const Image& image, const Body& body) {
  if (body.words.size() != 2) return refused(code::body_invalid, "unforce takes a tag, or all");
  if (body.words[1] != "all") return with_tag(image, Verb::unforce, body.words[1], forceable);
  CheckedOrder order;
  order.request.verb = Verb::unforce_all;
  return order;
}

CheckedOrder check_set(const Image& image, const Body& body) {
  if (body.words.size() != 3) return refused(code::body_invalid, "set takes a tag and a value");
  CheckedOrder order =
      with_tag(image, Verb::set, body.words[1], [](const TagSpec& spec) { return spec.writable; });
  if (order.refusal != 0) return order;
  const TagSpec& spec = image.spec(order.request.tag);
  if (spec.writable) return with_value(image, order, body.words[2]);
  return refused(code::not_writable,
                 spec.name + (forceable(spec) ? " is " + area_text(spec) + ": it can be forced, not set"
                                              : " is not declared writable in the configuration"));
}

CheckedOrder check_get(const Image& image, const Body& body) {
  if (body.words.size() != 2) return refused(code::body_invalid, "get takes one argument");
  CheckedOrder order = with_tag(image, Verb::get, body.words[1], any);
  if (order.refusal == 0 && image.spec(order.request.tag).type == TagType::STRING)
    return refused(code::value_invalid, body.words[1] + " is a STRING: not to be asked for");
  return order;
}

CheckedOrder check_tags(const Image& image, const Body& body) {
  const std::size_t words = body.words.size();
  CheckedOrder order;
  order.request.verb = Verb::tags;
  if (words == 1) return order;
  const bool after = words == 3 && body.words[1] == "after";
  if (words != 2 && !after) return refused(code::body_invalid, "tags takes a tag, or `after` and a tag");
  order = with_tag(image, Verb::tags, body.words.back(), any);
  order.request.value = after ? 0 : 1;
  if (after) ++order.request.tag;
  return order;
}

using Check = CheckedOrder (*)(const Image&, const Body&);
constexpr auto kChecks = std::to_array<std::pair<std::string_view, Check>>({{"get", check_get},
                                                                            {"tags", check_tags},
                                                                            {"force", check_force},
                                                                            {"unforce", check_unforce},
                                                                            {"set", check_set}});

Check check_of(std::string_view verb) noexcept {
  for (const auto& [name, check] : kChecks)
    if (name == verb) return check;
  return nullptr;
}

std::string forced_text(const TagSpec& spec, TagIndex tag, const TagChanges& changes) {
  const auto force = changes.forced.find(tag);
  return force == changes.forced.end() ? "" : " forced=" + format_value(spec.type, force->second);
}

std::string line_of(const TagSpec& spec, Slot value, Quality quality) {
  std::string line = "tag=" + spec.name + " value=" + format_value(spec.type, value);
  line.append(" quality=").append(name_of(quality)).append(" area=").append(name_of(spec.area));
  return line.append(" type=").append(name_of(spec.type));
}

std::string rights_of(const TagSpec& spec) {
  const std::string range = spec.parameter || spec.writable ? format_range(spec) : "";
  return std::string(spec.writable ? " writable=true" : "") + (range.empty() ? "" : " range=" + range) +
         (spec.unit.empty() ? "" : " unit=" + spec.unit);
}

}  // namespace

bool is_tag_verb(std::string_view verb) noexcept { return check_of(verb) != nullptr; }

CheckedOrder check_tag_order(const Image& image, const Body& body) {
  return check_of(body.words[0])(image, body);
}

std::vector<std::string> take_change(const Image& image, const Request& request, const Reply& reply,
                                     TagChanges& changes) {
  if (reply.outcome != Outcome::done || !reply.changed) return {};
  const TagSpec& spec = image.spec(request.tag);
  const std::string value = format_value(spec.type, request.value);
  std::vector<std::string> lines;
  switch (request.verb) {
    case Verb::force:
      changes.forced[request.tag] = request.value;
      return {"tag " + spec.name + " forced to " + value};
    case Verb::unforce: changes.forced.erase(request.tag); return {"tag " + spec.name + " unforced"};
    case Verb::unforce_all:
      for (const auto& [tag, forced] : changes.forced)
        lines.push_back("tag " + image.spec(tag).name + " unforced");
      changes.forced.clear();
      return lines;
    case Verb::set:
      changes.set[request.tag] = request.value;
      return {"tag " + spec.name + " set to " + value + " (was " + format_value(spec.type, reply.value) +
              ")"};
    default: return {};
  }
}

std::string tag_answer(const Image& image, const Request& request, const Reply& reply,
                       const TagChanges& changes) {
  const TagSpec& spec = image.spec(request.tag);
  const std::string count = " unforced=" + std::to_string(reply.value);
  switch (request.verb) {
    case Verb::get:
      return spec.name + "=" + format_value(spec.type, reply.value) +
             " quality=" + std::string(name_of(reply.quality)) + forced_text(spec, request.tag, changes);
    case Verb::force: {
      const bool waits = spec.area == Area::output && !driven(reply.state);
      return "tag=" + spec.name + " forced=" + format_value(spec.type, request.value) +
             (waits ? " note=the output stays safe until the station runs" : "");
    }
    case Verb::unforce: return "tag=" + spec.name + count;
    case Verb::unforce_all: return "tag=all" + count;
    case Verb::set:
      return "tag=" + spec.name + " value=" + format_value(spec.type, request.value) +
             " before=" + format_value(spec.type, reply.value);
    default: return "done";
  }
}

std::string tags_answer(const Image& image, const Request& request, ConstBlockView copy,
                        const TagChanges& changes, std::size_t room) {
  const std::size_t wanted = request.value == 0 ? image.size() : request.value;
  const std::size_t end = std::min<std::size_t>(image.size(), request.tag + wanted);
  constexpr std::size_t kNextLine = 6 + 64;  // "\nnext=" and a name
  std::string text;
  const Slot* slot = copy.slots().data();
  for (TagIndex tag = 0; tag < request.tag; ++tag) slot += image.slot_count(tag);
  for (TagIndex tag = request.tag; tag < end; ++tag) {
    const TagSpec& spec = image.spec(tag);
    const std::string line =
        line_of(spec, *slot, copy.qualities()[tag]) + forced_text(spec, tag, changes) + rights_of(spec);
    if (!text.empty() && text.size() + 1 + line.size() + kNextLine > room)
      return text + "\nnext=" + image.spec(tag - 1).name;
    text += (text.empty() ? "" : "\n") + line;
    slot += image.slot_count(tag);
  }
  return text.empty() ? "no more tags" : text;
}

}  // namespace stationd::bus

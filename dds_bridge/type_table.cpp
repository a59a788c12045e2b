#include "dds_bridge/type_table.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "dds_bridge/cdr.hpp"
#include "dds_bridge/compat.hpp"

namespace stationd::bus {
namespace {

constexpr std::size_t kEncapsulation = 4;
constexpr std::size_t kUsualText = 64;
constexpr std::size_t kPlainKey = 16;
constexpr std::size_t kPadding = 4;  // a payload may be padded to a multiple of this

std::size_t aligned(std::size_t position, std::size_t alignment) {
  return (position + alignment - 1) / alignment * alignment;
}

const std::string& text_of(const void* object, const Member& member) {
  return *reinterpret_cast<const std::string*>(static_cast<const char*>(object) + member.offset);
}

template <class T> void put_number(CdrStream& out, const Member& member, const void* object) {
  T value;
  std::memcpy(&value, static_cast<const char*>(object) + member.offset, sizeof(T));
  out.put(value);
}

template <class T> T get_number(CdrStream& in, const Member& member, void* object) {
  T value{};
  in.get(value);
  std::memcpy(static_cast<char*>(object) + member.offset, &value, sizeof(T));
  return value;
}

void put_member(CdrStream& out, const Member& member, const void* object) {
  switch (member.kind) {
    case Kind::int8: put_number<std::int8_t>(out, member, object); return;
    case Kind::boolean:
    case Kind::uint8: put_number<std::uint8_t>(out, member, object); return;
    case Kind::int16: put_number<std::int16_t>(out, member, object); return;
    case Kind::uint16: put_number<std::uint16_t>(out, member, object); return;
    case Kind::int32: put_number<std::int32_t>(out, member, object); return;
    case Kind::enumeration:
    case Kind::uint32: put_number<std::uint32_t>(out, member, object); return;
    case Kind::int64: put_number<std::int64_t>(out, member, object); return;
    case Kind::uint64: put_number<std::uint64_t>(out, member, object); return;
    case Kind::float32: put_number<float>(out, member, object); return;
    case Kind::float64: put_number<double>(out, member, object); return;
    case Kind::text: {
      const std::string& text = text_of(object, member);
      out.put(static_cast<std::uint32_t>(text.size() + 1));
      out.put_chars(text.c_str(), text.size() + 1);
      return;
    }
  }
}

bool get_text(CdrStream& in, const Member& member, void* object) {
  std::uint32_t length = 0;
  in.get(length);
  if (length == 0 || length - 1 > member.bound || length > in.remaining()) return false;
  std::string& text = *reinterpret_cast<std::string*>(static_cast<char*>(object) + member.offset);
  text.resize(length);
  in.get_chars(text.data(), length);
  if (text.back() != '\0') return false;
  text.pop_back();
  return text.find('\0') == std::string::npos && (!member.utf8 || is_utf8(text));
}

bool get_member(CdrStream& in, const Member& member, void* object) {
  switch (member.kind) {
    case Kind::boolean: {
      std::uint8_t value = 0;  // anything but 0 and 1 must not reach a bool
      in.get(value);
      const bool truth = value == 1;
      std::memcpy(static_cast<char*>(object) + member.offset, &truth, sizeof(truth));
      return value <= 1;
    }
    case Kind::enumeration: return get_number<std::uint32_t>(in, member, object) < member.enumerators.size();
    case Kind::int8: get_number<std::int8_t>(in, member, object); return true;
    case Kind::uint8: get_number<std::uint8_t>(in, member, object); return true;
    case Kind::int16: get_number<std::int16_t>(in, member, object); return true;
    case Kind::uint16: get_number<std::uint16_t>(in, member, object); return true;
    case Kind::int32: get_number<std::int32_t>(in, member, object); return true;
    case Kind::uint32: get_number<std::uint32_t>(in, member, object); return true;
    case Kind::int64: get_number<std::int64_t>(in, member, object); return true;
    case Kind::uint64: get_number<std::uint64_t>(in, member, object); return true;
    case Kind::float32: get_number<float>(in, member, object); return true;
    case Kind::float64: get_number<double>(in, member, object); return true;
    case Kind::text: return get_text(in, member, object);
  }
  return false;
}

/// Whether the sample ends before a member of that alignment: nothing is left, or padding too short for one.
bool ends_before(const CdrStream& in, const Member& member) {
  const std::size_t left = in.remaining();
  return left < kPadding && aligned(in.position(), size_of(member.kind)) >= in.position() + left;
}

bool decode_members(const TypeTable& table, CdrStream& in, void* object) {
  for (std::size_t i = 0; i < table.members.size(); ++i) {
    if (ends_before(in, table.members[i]))
      return std::ranges::find(table.released, i) != table.released.end();
    if (!get_member(in, table.members[i], object)) return false;
  }
  return true;
}

std::optional<CdrStream::Endian> endian_of(std::span<const std::byte> payload) {
  if (payload.size() < kEncapsulation || payload[0] != std::byte{0}) return std::nullopt;
  if (payload[1] == std::byte{0}) return CdrStream::Endian::big;
  if (payload[1] == std::byte{1}) return CdrStream::Endian::little;
  return std::nullopt;
}

/// Fast CDR reads through pointers that are not const; it does not write when reading.
std::span<std::byte> body_of(std::span<const std::byte> payload) {
  return {const_cast<std::byte*>(payload.data()) + kEncapsulation, payload.size() - kEncapsulation};
}

std::size_t largest_key(const TypeTable& table) {
  std::size_t position = 0;
  for (const Member& member : table.members) {
    if (!member.key) continue;
    position = aligned(position, size_of(member.kind)) + size_of(member.kind);
    if (member.kind == Kind::text) position += member.bound + 1;
  }
  return position;
}

const char* idl_name(Kind kind) {
  static constexpr std::array<const char*, 13> names = {"boolean",
                                                        "int8",
                                                        "octet",
                                                        "short",
                                                        "unsigned short",
                                                        "long",
                                                        "unsigned long",
                                                        "long long",
                                                        "unsigned long long",
                                                        "float",
                                                        "double",
                                                        "string",
                                                        ""};
  return names[static_cast<std::size_t>(kind)];
}

std::string enumeration_idl(const Member& member) {
  std::string idl("enum ");
  idl.append(member.enum_name).append(" {");
  for (std::size_t i = 0; i < member.enumerators.size(); ++i)
    idl.append(i == 0 ? " " : ", ").append(member.enumerators[i]);
  return idl + " };\n";
}

std::string member_idl(const Member& member) {
  std::string idl(member.key ? "  @key " : "  ");
  if (member.kind == Kind::enumeration)
    idl += member.enum_name;
  else
    idl += idl_name(member.kind);
  // Only keys are bounded in the IDL: other generators need to know the key's longest, and the wire does
  // not differ.
  if (member.kind == Kind::text && member.key) idl += "<" + std::to_string(member.bound) + ">";
  return idl.append(" ").append(member.name).append(";\n");
}

}  // namespace

std::size_t size_of(Kind kind) noexcept {
  static constexpr std::array<std::size_t, 13> sizes = {1, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8, 4, 4};
  return sizes[static_cast<std::size_t>(kind)];
}

const Member* TypeTable::find(std::string_view member) const noexcept {
  const auto it = std::ranges::find(members, member, &Member::name);
  return it != members.end() ? &*it : nullptr;
}

bool TypeTable::keyed() const noexcept { return std::ranges::any_of(members, &Member::key); }

std::uint32_t TypeTable::usual_size() const noexcept {
  std::size_t size = kEncapsulation;
  for (const Member& member : members) {
    size = aligned(size, size_of(member.kind)) + size_of(member.kind);
    if (member.kind == Kind::text) size += std::min<std::size_t>(member.bound, kUsualText) + 1;
  }
  return static_cast<std::uint32_t>(aligned(size, kPadding));
}

std::uint32_t encoded_size(const TypeTable& table, const void* object) noexcept {
  std::size_t position = 0;
  for (const Member& member : table.members) {
    position = aligned(position, size_of(member.kind)) + size_of(member.kind);
    if (member.kind != Kind::text) continue;
    const std::size_t length = text_of(object, member).size();
    if (length > member.bound) return 0;
    position += length + 1;
  }
  return static_cast<std::uint32_t>(aligned(position + kEncapsulation, kPadding));
}

std::uint32_t encode(const TypeTable& table, const void* object, std::span<std::byte> out) noexcept try {
  const std::uint32_t size = encoded_size(table, object);
  if (size == 0 || size > out.size()) return 0;
  std::memset(out.data() + size - kPadding, 0, kPadding);  // the padding; the rest is overwritten
  const std::array<std::byte, kEncapsulation> little = {std::byte{0}, std::byte{1}, std::byte{0},
                                                        std::byte{0}};
  std::ranges::copy(little, out.begin());
  CdrStream stream(out.subspan(kEncapsulation, size - kEncapsulation), CdrStream::Endian::little);
  for (const Member& member : table.members) put_member(stream, member, object);
  return size;
} catch (...) {
  return 0;
}

bool decode(const TypeTable& table, std::span<const std::byte> payload, void* object) noexcept {
  table.reset(object);
  try {
    if (const auto endian = endian_of(payload)) {
      CdrStream stream(body_of(payload), *endian);
      if (decode_members(table, stream, object)) return true;
    }
  } catch (...) {  // the sample ended within a member
  }
  table.reset(object);
  return false;
}

std::optional<std::string_view> peek_text(const TypeTable& table, std::string_view name,
                                          std::span<const std::byte> payload) noexcept try {
  const auto endian = endian_of(payload);
  if (!endian) return std::nullopt;
  const std::span<std::byte> body = body_of(payload);
  CdrStream stream(body, *endian);
  for (const Member& member : table.members) {
    // Members before it are skipped by their size, with their alignment, in this stream's own way of
    // counting.
    std::uint32_t length = 0;
    std::uint64_t skipped = 0;
    switch (size_of(member.kind)) {
      case 1: {
        std::uint8_t value = 0;
        stream.get(value);
        break;
      }
      case 2: {
        std::uint16_t value = 0;
        stream.get(value);
        break;
      }
      case 4: stream.get(length); break;
      default: stream.get(skipped); break;
    }
    if (member.kind != Kind::text) continue;
    if (length == 0 || length > stream.remaining()) return std::nullopt;
    const char* chars = reinterpret_cast<const char*>(body.data()) + stream.position();
    if (member.name == name) return std::string_view(chars, length - 1);
    std::vector<char> skip(length);
    stream.get_chars(skip.data(), length);
  }
  return std::nullopt;
} catch (...) {
  return std::nullopt;
}

bool key_hash(const TypeTable& table, const void* object, bool force_md5, KeyHash& hash) noexcept try {
  std::size_t size = 0;
  for (const Member& member : table.members) {
    if (!member.key) continue;
    size = aligned(size, size_of(member.kind)) + size_of(member.kind);
    if (member.kind != Kind::text) continue;
    const std::size_t length = text_of(object, member).size();
    if (length > member.bound) return false;
    size += length + 1;
  }
  if (size == 0) return false;
  std::array<std::byte, 1024> small;
  std::vector<std::byte> large(size > small.size() ? size : 0);
  const std::span<std::byte> key = large.empty() ? std::span(small).first(size) : std::span(large);
  std::ranges::fill(key, std::byte{0});
  CdrStream stream(key, CdrStream::Endian::big);
  for (const Member& member : table.members) {
    if (member.key) put_member(stream, member, object);
  }
  hash.fill(0);
  if (!force_md5 && largest_key(table) <= kPlainKey) {
    std::memcpy(hash.data(), key.data(), size);
    return true;
  }
  compat::Md5 md5;
  md5.init();
  md5.update(reinterpret_cast<const unsigned char*>(key.data()), static_cast<unsigned>(size));
  md5.finalize();
  std::ranges::copy(md5.digest, hash.begin());
  return true;
} catch (...) {
  return false;
}

std::string idl_of(const TypeTable& table) {
  std::string idl;
  for (const Member& member : table.members) {
    if (member.kind == Kind::enumeration) idl += enumeration_idl(member);
  }
  if (const auto first = std::ranges::find_if(table.members, [](auto& m) { return !m.group.empty(); });
      first != table.members.end()) {
    idl.append("@final struct ").append(first->group_type).append(" {\n");
    for (const Member& member : table.members)
      if (member.group == first->group) idl += member_idl(member);
    idl += "};\n\n";
  }
  idl.append("@final struct ").append(table.name).append(" {\n");
  std::string_view group;
  for (std::size_t i = 0; i < table.members.size(); ++i) {
    const Member& member = table.members[i];
    if (table.paper_members != 0 && i == table.paper_members)
      idl += "  // appended to the paper's Table 4:\n";
    if (member.group.empty())
      idl += member_idl(member);
    else if (member.group != group)
      idl.append("  ").append(member.group_type).append(" ").append(member.group).append(";\n");
    group = member.group;
  }
  return idl + "};\n";
}

bool is_utf8(std::string_view text) noexcept {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    std::size_t more = 0;
    std::uint32_t point = 0, least = 0;
    if (lead < 0x80) {
      ++i;
      continue;
    }
    if ((lead & 0xE0U) == 0xC0) {
      more = 1;
      point = lead & 0x1FU;
      least = 0x80;
    } else if ((lead & 0xF0U) == 0xE0) {
      more = 2;
      point = lead & 0x0FU;
      least = 0x800;
    } else if ((lead & 0xF8U) == 0xF0) {
      more = 3;
      point = lead & 0x07U;
      least = 0x10000;
    } else
      return false;
    if (i + more >= text.size()) return false;
    for (std::size_t k = 1; k <= more; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      if ((next & 0xC0U) != 0x80) return false;
      point = (point << 6U) | (next & 0x3FU);
    }
    if (point < least || point > 0x10FFFF || (point >= 0xD800 && point <= 0xDFFF)) return false;
    i += more + 1;
  }
  return true;
}

}  // namespace stationd::bus

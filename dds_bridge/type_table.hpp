// TypeTable: a topic type as a table of members; from it come encoding, decoding, key hash and IDL.
// Private to dds_bridge. The cell's own tables are constant data (cell_types.hpp); others can be made at
// set-up.
// Any plain thread; nothing here throws once the table exists.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace stationd::bus {

/// How a member is stored in its struct (a C++ type of that size; `text`: std::string) and encoded.
enum class Kind : std::uint8_t {
  boolean,
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64,
  text,
  enumeration
};

/// Bytes a member of that kind takes on the wire and by which it is aligned (text: its length).
std::size_t size_of(Kind kind) noexcept;

struct Member {
  std::string_view name;
  Kind kind;
  std::size_t offset;  ///< of the field within its struct
  bool key = false;
  std::uint32_t bound = 0;  ///< text: most bytes, checked when writing and when reading
  bool utf8 = true;         ///< text: a sample with other bytes is malformed
  std::string_view enum_name = {};
  std::span<const std::string_view> enumerators = {};  ///< of values 0, 1, ...
  /// Members in a row with the same group are one member of that name in the IDL, a struct of type
  /// `group_type` (on the wire that is the same). Each group of a type has the members of the first.
  std::string_view group = {};
  std::string_view group_type = {};
};

struct TypeTable {
  std::string_view name;  ///< on the wire
  std::span<const Member> members;
  /// Numbers of leading members after which a sample may end: one per release that appended members,
  /// ascending; the last one is members.size(). Such a prefix must not be followed by a member of one byte
  /// unless it ends on a multiple of four bytes, or padding could pass for that member.
  std::span<const std::size_t> released;
  std::size_t paper_members = 0;  ///< Table 4's; 0: the type is not in the paper
  void* (*make)() = nullptr;      ///< a new struct with its defaults
  void (*drop)(void*) = nullptr;
  void (*reset)(void*) = nullptr;  ///< back to the defaults

  const Member* find(std::string_view member) const noexcept;
  bool keyed() const noexcept;
  /// Size of an ordinary sample: what is allocated beforehand. Longer ones are allocated as they come.
  std::uint32_t usual_size() const noexcept;
};

/// Bytes of the encoded sample with its 4 bytes of encapsulation; 0 if a text is longer than its bound.
std::uint32_t encoded_size(const TypeTable& table, const void* object) noexcept;

/// Encodes as XCDR1, little endian. Returns the bytes written; 0 if `out` is too short or a text too long.
std::uint32_t encode(const TypeTable& table, const void* object, std::span<std::byte> out) noexcept;

/// Decodes XCDR1 of either endianness; members that the sample does not have get their defaults, bytes behind
/// the last member are a newer release's. False (and defaults) for a malformed sample.
bool decode(const TypeTable& table, std::span<const std::byte> payload, void* object) noexcept;

/// The text member of that name out of an encoded sample, without the rest; valid as long as `payload`. Empty
/// if the sample is malformed up to there.
std::optional<std::string_view> peek_text(const TypeTable& table, std::string_view member,
                                          std::span<const std::byte> payload) noexcept;

using KeyHash = std::array<std::uint8_t, 16>;
/// Key hash of RTPS 9.6.4.8: the big-endian key itself where no key can be longer than 16 bytes, else its
/// MD5. False if the type has no key or a key's text is longer than its bound.
bool key_hash(const TypeTable& table, const void* object, bool force_md5, KeyHash& hash) noexcept;

/// The type's IDL, with an enumeration's before it.
std::string idl_of(const TypeTable& table);

/// Whether the bytes are well-formed UTF-8.
bool is_utf8(std::string_view text) noexcept;

}  // namespace stationd::bus

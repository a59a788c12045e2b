// Key tables: every section and key that a file may have; others are errors. The reference is made from them.
// Owned by the program text; constant.
// Any thread.
#pragma once

#include <span>
#include <string_view>

namespace stationd::config {

struct Key {
  std::string_view name;
  std::string_view
      kind;  ///< text, integer, number, duration, size, boolean, list, table, or what may be chosen
  std::string_view fallback;  ///< default in words; empty: the key is required
  std::string_view about;     ///< meaning and what is allowed
};

struct SectionKeys {
  std::string_view name;     ///< "device"
  std::string_view heading;  ///< as it stands in the file: "[[device]]"
  std::string_view about;
  std::span<const Key> keys;
  bool free_keys = false;  ///< others than those listed are allowed (tags, a recipe's values)
};

extern const SectionKeys kControllerKeys, kLogKeys, kBusKeys, kTaskKeys, kDeviceKeys, kDeviceHeartbeatKeys,
    kPlantKeys, kRecipeKeys, kStationKeys, kInputKeys, kOutputKeys, kParameterKeys, kTagKeys, kSupervisorKeys;

/// Sections of a controller's file and of a supervisor's, in the order of the reference.
std::span<const SectionKeys* const> controller_sections();
std::span<const SectionKeys* const> supervisor_sections();

}  // namespace stationd::config

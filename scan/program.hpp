// Program: a station's logic, and the typed handles by which it sees its tags.
// Owned by the station; written by users (copy one of programs/*.cpp).
// Constructed in set-up (may allocate and throw); execute() and idle() run in the scan thread and may do
// neither.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "scan/image.hpp"
#include "scan/messages.hpp"
#include "scan/nonblocking.hpp"
#include "scan/value.hpp"

namespace stationd {

class Cycle;
class Program;

/// A recipe of the configuration: a type of piece with its parts and times. Times are in nanoseconds.
struct Recipe {
  std::uint32_t code = 0;
  std::string name;
  std::vector<std::pair<std::string, std::int64_t>> values;
  /// The value of that name; throws SetupError naming recipe and value when it is missing or out of [min,
  /// max].
  std::int64_t value(std::string_view name, std::int64_t min, std::int64_t max) const;
};

/// What a program is told at set-up.
struct ProgramOptions {
  std::string station;
  std::string upstream;    ///< station before this one; empty: none (the cell's infeed)
  std::string downstream;  ///< station behind this one; empty: none (the outfeed)
  std::vector<Recipe> recipes;
};

/// A tag as a program declares it; bound to its place in the image when the station is built.
class Handle {
 public:
  Handle(Program& owner, TagSpec spec);
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  const TagSpec& spec() const noexcept { return spec_; }
  Quality quality() const noexcept { return *quality_; }
  bool good() const noexcept { return *quality_ >= Quality::GOOD; }
  /// Set-up, by the station.
  void bind(Slot* slot, Quality* quality) noexcept {
    slot_ = slot;
    quality_ = quality;
  }

 protected:
  Slot* slot_ = nullptr;

 private:
  Quality* quality_ = nullptr;
  TagSpec spec_;
};

template <class T> TagSpec tag_spec(std::string name, Area area, std::string description, T initial = T{}) {
  TagSpec spec;
  spec.name = std::move(name);
  spec.type = TagTypeOf<T>::value;
  spec.area = area;
  spec.description = std::move(description);
  spec.initial = to_slot(initial);
  return spec;
}

/// An input: read only. `bool` inputs read as false, numbers as 0, while their source was never seen.
template <class T> class In : public Handle {
 public:
  In(Program& owner, std::string name, std::string description)
      : Handle(owner, tag_spec<T>(std::move(name), Area::input, std::move(description))) {}
  T get() const noexcept { return from_slot<T>(*slot_); }
  operator T() const noexcept { return get(); }
};

/// An output. Outside RUNNING and STOPPING the engine puts it to its safe value (or holds it).
template <class T> class Out : public Handle {
 public:
  Out(Program& owner, std::string name, std::string description, bool hold = false)
      : Handle(owner, with_hold(tag_spec<T>(std::move(name), Area::output, std::move(description)), hold)) {}
  T get() const noexcept { return from_slot<T>(*slot_); }
  operator T() const noexcept { return get(); }
  void set(T value) noexcept { *slot_ = to_slot(value); }
  Out& operator=(T value) noexcept {
    set(value);
    return *this;
  }
  /// The other's value; a handle itself stays what it is.
  Out& operator=(const Out& other) noexcept { return *this = other.get(); }

 private:
  static TagSpec with_hold(TagSpec spec, bool hold) {
    spec.hold = hold;
    return spec;
  }
};

/// An internal or retained tag of the program's own.
template <class T, Area area> class Own : public Handle {
 public:
  Own(Program& owner, std::string name, std::string description, T initial = T{})
      : Handle(owner, tag_spec<T>(std::move(name), area, std::move(description), initial)) {}
  T get() const noexcept { return from_slot<T>(*slot_); }
  operator T() const noexcept { return get(); }
  void set(T value) noexcept { *slot_ = to_slot(value); }
  Own& operator=(T value) noexcept {
    set(value);
    return *this;
  }
  /// The other's value; a handle itself stays what it is.
  Own& operator=(const Own& other) noexcept { return *this = other.get(); }
};
template <class T> using Var = Own<T, Area::internal>;
/// Retained: kept over a restart of the daemon. See Cycle::save_retained().
template <class T> using Retained = Own<T, Area::retained>;

/// A parameter: internal, its value from the configuration or a Start order; read only for the program.
template <class T> class Param : public Handle {
 public:
  Param(Program& owner, std::string name, std::string description, T initial, T min, T max)
      : Handle(owner, limited(tag_spec<T>(std::move(name), Area::internal, std::move(description), initial),
                              min, max)) {}
  T get() const noexcept { return from_slot<T>(*slot_); }
  operator T() const noexcept { return get(); }

 private:
  static TagSpec limited(TagSpec spec, T min, T max) {
    spec.parameter = true;
    spec.min = to_slot(min);
    spec.max = to_slot(max);
    return spec;
  }
};

/// A topic's member and the tag that it carries.
struct PvMember {
  std::string name;
  const Handle* handle;
};

/// A PV group that the program publishes (member STATION is the station's name and not listed).
struct PvPublication {
  std::string topic;
  std::vector<PvMember> members;
};

/// A remote PV that the program takes as inputs: all listed members come from one sample, together.
struct PvSubscription {
  std::string topic;
  std::string station;  ///< whose
  std::vector<PvMember> members;
};

class Program {
 public:
  Program() = default;
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  virtual ~Program() = default;

  /// One scan in RUNNING or STOPPING. Must not allocate, block, log or ask for the time: Cycle has all it
  /// needs.
  virtual void execute(Cycle& cycle) noexcept STATIOND_NONBLOCKING = 0;

  /// One scan in STOPPED or FAULT: watch inputs and announcements; outputs set here have no effect.
  virtual void idle(Cycle& cycle) noexcept STATIOND_NONBLOCKING { static_cast<void>(cycle); }

  /// Whether the cause of the active fault is gone, asked when `reset` is ordered. 0: reset may be accepted;
  /// else the code of what still stands in the way.
  virtual std::uint32_t reset_obstacle(const Cycle& cycle) noexcept STATIOND_NONBLOCKING {
    static_cast<void>(cycle);
    return 0;
  }

  /// The name of a step for people; empty if there is none.
  virtual std::string_view step_name(std::uint32_t step) const noexcept {
    static_cast<void>(step);
    return {};
  }

  // Set-up, by the station.
  const std::vector<Handle*>& handles() const noexcept { return handles_; }
  const std::vector<PvPublication>& publications() const noexcept { return publications_; }
  const std::vector<PvSubscription>& subscriptions() const noexcept { return subscriptions_; }

 protected:
  /// Constructor of a program only.
  void publish(std::string topic, std::vector<PvMember> members) {
    publications_.push_back({std::move(topic), std::move(members)});
  }
  void subscribe(std::string topic, std::string station, std::vector<PvMember> members) {
    subscriptions_.push_back({std::move(topic), std::move(station), std::move(members)});
  }

 private:
  friend class Handle;
  std::vector<Handle*> handles_;
  std::vector<PvPublication> publications_;
  std::vector<PvSubscription> subscriptions_;
};

}  // namespace stationd

// BusOut: from the scans to the bus: PVs, Status, replies; hands events on to their writer.
// Private to dds_bridge; owned by the bridge.
// Set-up by one thread, then the bus-out thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "dds_bridge/bridge_context.hpp"
#include "dds_bridge/cell_types.hpp"
#include "dds_bridge/event_writer.hpp"
#include "dds_bridge/field_map.hpp"

namespace stationd::bus {

class BusOut {
 public:
  /// Throws BusError for a PV whose topic, member or type does not fit.
  BusOut(Context& context, EventWriter& events);

  /// Names of the PV topics that the stations publish.
  std::vector<std::string> topics() const;
  /// One pass over all stations.
  void pass(std::int64_t now_ns);
  /// The last word, after the scans have ended: each Status once more, not ready for anything. STATE stays
  /// as it
  /// was: a supervisor shall not take the end of a daemon for an operator's Stop.
  void farewell();

 private:
  struct Object {  // a message's struct, made by its table
    const TypeTable* table;
    void* data;
    explicit Object(const TypeTable& type) : table(&type), data(type.make()) {}
    Object(Object&& other) noexcept : table(other.table), data(std::exchange(other.data, nullptr)) {}
    Object& operator=(Object&&) = delete;
    ~Object() {
      if (data != nullptr) table->drop(data);
    }
  };
  struct Pv {
    PvLink* link;
    const TopicInfo* topic;
    std::vector<FieldMap> maps;
    Object object;
  };
  struct Out {
    BridgedEntry* entry;
    std::vector<Pv> pvs;
    StatusRecord said;    // by the scan
    StatusRecord record;  // as published
    Status status;
    std::int64_t sent_ns = 0;    // Status; 0: never
    std::int64_t record_ns = 0;  // when the record was taken; 0: never
  };

  Pv make_pv(const Station& station, PvLink& link) const;
  void send_events(Out& out);
  void send_event(Station& station, const Event& event);
  void send_pvs(Out& out);
  template <class T> void send_pv(const Pv& pv, const Station& station, const Slot* slots, T& message);
  void send_status(Out& out, std::int64_t now_ns);
  void fill_status(Out& out);
  void say_state(const Out& out, const StatusRecord& before, std::int64_t now_ns) const;
  void send_replies(Out& out);
  void settle(const Pending& pending, const Reply& reply);
  void settle_start(const Pending& pending, const Reply& reply);
  std::string settle_tags(const Pending& pending, const Reply& reply) const;

  Context& context_;
  EventWriter& events_;
  std::vector<Out> outs_;
};

}  // namespace stationd::bus

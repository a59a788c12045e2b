// TagOrders: requests about single tags (get, tags, force, unforce, set): checked against the image, and what
// is said when the scan has carried them out.
// Private to dds_bridge; no state of its own.
// check_tag_order() the bus-in thread, the rest the bus-out thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "dds_bridge/body.hpp"
#include "scan/links.hpp"
#include "scan/messages.hpp"

namespace stationd::bus {

/// What operators changed in a station since the daemon started, in the order in which its scan did.
struct TagChanges {
  std::map<TagIndex, Slot> set;     ///< parameters by Start, any writable tag by `set`
  std::map<TagIndex, Slot> forced;  ///< those that stand
};

struct CheckedOrder {
  Request request;
  std::uint32_t refusal = 0;  ///< code; 0: the scan may have it
  std::string problem;        ///< for people
};

bool is_tag_verb(std::string_view verb) noexcept;

/// `body` begins with a tag verb. Name, kind, type and range are checked; nothing is applied.
///   get TAG | tags [TAG] | tags after TAG | force TAG VALUE | unforce TAG|all | set TAG VALUE
CheckedOrder check_tag_order(const Image& image, const Body& body);

/// Takes over what the scan has done; a line for the log for each tag that changed.
std::vector<std::string> take_change(const Image& image, const Request& request, const Reply& reply,
                                     TagChanges& changes);

/// The answer to get, force, unforce and set, without the station's state.
std::string tag_answer(const Image& image, const Request& request, const Reply& reply,
                       const TagChanges& changes);

/// The answer to tags: a line for each tag, `tag=NAME value=V quality=Q area=A type=T` and what else there is
/// to say: `forced=V`, `writable=true`, `range=LOW..HIGH`, `unit=U`. What does not fit into `room` bytes is
/// asked for with `tags after NAME`, as the last line, `next=NAME`, says.
std::string tags_answer(const Image& image, const Request& request, ConstBlockView copy,
                        const TagChanges& changes, std::size_t room);

}  // namespace stationd::bus

// Writers: the DDS writers of a Bus, one per topic, made at first use.
// Private to dds_bridge; owned by the Bus.
// Any plain thread.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "dds_bridge/participant.hpp"

namespace stationd::bus {

/// Knows which participants have a reader of our replies. The library's threads tell it, writers ask.
class ReplyReaders final : public compat::dds::DataWriterListener {
 public:
  void on_publication_matched(compat::dds::DataWriter* writer,
                              const compat::dds::PublicationMatchedStatus& status) override;
  /// Whether a reply to the sample of that origin would arrive: the participant that wrote it has a reader
  /// that this
  /// side knows and, where it is not a Fast DDS, some time to settle after its first question. Measured: a
  /// volatile
  /// reader of Cyclone DDS drops what was written before the first heartbeat that it takes, though both
  /// sides report
  /// a match.
  bool ready(const Origin& origin, std::int64_t now_ns);

 private:
  using Prefix = std::array<std::uint8_t, 12>;
  struct Peer {
    int readers = 0;
    std::int64_t asked_ns = 0;  // first; 0: never
  };
  std::mutex mutex_;
  std::map<Prefix, Peer> peers_;
};

class Writers {
 public:
  explicit Writers(Participant& participant) : participant_(participant) {}
  ~Writers();
  Writers(const Writers&) = delete;
  Writers& operator=(const Writers&) = delete;

  /// Throws BusError when the writer cannot be made.
  void prepare(TopicId id);
  /// False: refused, counted. `object` is the message's struct.
  bool write(TopicId id, const void* object) noexcept;
  /// With a relation to another sample; returns the own identity in `identity`.
  bool write_related(TopicId id, const void* object, const Origin* related, Origin* identity) noexcept;
  /// A request can arrive before this side has discovered the reader for its reply, which would then be
  /// lost: such a
  /// reply waits, for half a second at most. False: refused, or too many wait.
  bool write_reply(const MsgRes& reply, const Origin& related) noexcept;
  /// Writes the replies that need not wait any more. The bus-in thread.
  void flush_replies(std::int64_t now_ns) noexcept;
  int matched(TopicId id) const;
  std::uint64_t failures() const noexcept { return failures_.load(std::memory_order_relaxed); }
  void describe(std::vector<EndpointQos>& list) const;
  /// Tells each incompatible reader that turned up since the last call: topic, policy.
  void report_incompatible(const std::function<void(const std::string&, const std::string&)>& report);

 private:
  struct Waiting {
    MsgRes reply;
    Origin related;
    std::int64_t until_ns;
  };
  compat::dds::DataWriter& writer(TopicId id);

  Participant& participant_;
  ReplyReaders reply_readers_;
  std::mutex waiting_mutex_;
  std::deque<Waiting> waiting_;
  std::mutex making_;
  std::array<std::atomic<compat::dds::DataWriter*>, kTopics> writers_{};
  std::atomic<std::uint64_t> failures_{0};
};

/// Name of a QoS policy by its number in DDS.
std::string policy_name(std::uint32_t policy);

}  // namespace stationd::bus

#include "dds_bridge/bus.hpp"

#include "dds_bridge/compat.hpp"
#include "dds_bridge/participant.hpp"
#include "dds_bridge/readers.hpp"
#include "dds_bridge/writers.hpp"

namespace stationd::bus {

struct Bus::Impl {
  explicit Impl(const Options& options) : participant(options), writers(participant) {}
  Participant participant;
  Writers writers;
  std::unique_ptr<Readers> readers;
};

Bus::Bus(const Options& options) : impl_(std::make_unique<Impl>(options)) {}
Bus::~Bus() = default;

void Bus::start(Handlers handlers) {
  if (impl_->readers != nullptr) throw BusError("the bus was started before");
  impl_->readers = std::make_unique<Readers>(impl_->participant, impl_->writers, std::move(handlers));
  impl_->readers->start();
}

void Bus::stop() noexcept {
  if (impl_->readers != nullptr) impl_->readers->stop();
}

bool Bus::write(const Set& sample) { return impl_->writers.write(TopicId::set, &sample); }
bool Bus::write(const End& sample) { return impl_->writers.write(TopicId::end, &sample); }
bool Bus::write(const Status& sample) { return impl_->writers.write(TopicId::status, &sample); }
bool Bus::write(const ScanStats& sample) { return impl_->writers.write(TopicId::stats, &sample); }
bool Bus::write(const Gse& sample) { return impl_->writers.write(TopicId::gse, &sample); }
bool Bus::write_start(const MsgReq& sample) { return impl_->writers.write(TopicId::start, &sample); }
bool Bus::write_stop(const MsgReq& sample) { return impl_->writers.write(TopicId::stop, &sample); }

bool Bus::write_request(const MsgReq& sample, Origin* identity) {
  return impl_->writers.write_related(TopicId::request, &sample, nullptr, identity);
}

bool Bus::write_reply(const MsgRes& sample, const Origin& related) {
  return impl_->writers.write_reply(sample, related);
}

void Bus::prepare_writers(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const TopicInfo* info = find_topic(name);
    if (info == nullptr) throw BusError("the cell has no topic " + name);
    impl_->writers.prepare(info->id);
  }
}

int Bus::matched_readers(const std::string& name) const {
  const TopicInfo* info = find_topic(name);
  return info == nullptr ? 0 : impl_->writers.matched(info->id);
}

bool Bus::own(const Origin& origin) const noexcept {
  return origin.writer_high == impl_->participant.prefix_high() &&
         static_cast<std::uint32_t>(origin.writer_low >> 32U) == impl_->participant.prefix_low();
}

Origin Bus::self() const noexcept {
  Origin origin;
  origin.writer_high = impl_->participant.prefix_high();
  origin.writer_low = std::uint64_t{impl_->participant.prefix_low()} << 32U;
  return origin;
}

const Options& Bus::options() const noexcept { return impl_->participant.options; }

std::vector<EndpointQos> Bus::endpoints() const {
  std::vector<EndpointQos> list;
  impl_->writers.describe(list);
  if (impl_->readers != nullptr) impl_->readers->describe(list);
  return list;
}

std::uint64_t Bus::failures() const noexcept { return impl_->writers.failures(); }
std::uint64_t Bus::malformed() const noexcept {
  return impl_->participant.malformed.load(std::memory_order_relaxed);
}

std::string dds_version() { return std::string("Fast DDS ") + compat::kVersion; }

}  // namespace stationd::bus

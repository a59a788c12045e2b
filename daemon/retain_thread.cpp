#include "daemon/retain_thread.hpp"

#include <chrono>
#include <utility>

#include "scan/rt_thread.hpp"

namespace stationd {
namespace {

constexpr std::chrono::milliseconds kLookEvery{5};

}  // namespace

RetainThread::RetainThread(RetainLog log, std::int64_t interval_ns)
    : log_(std::move(log)), interval_ns_(interval_ns) {}

RetainThread::~RetainThread() { stop(); }

void RetainThread::add(Station& station, std::unique_ptr<RetainTarget> target) {
  items_.push_back({&station, std::move(target)});
}

void RetainThread::start() {
  thread_ = std::thread([this] { loop(); });
  pthread_setname_np(thread_.native_handle(), "retain");
}

void RetainThread::stop() noexcept {
  if (!thread_.joinable()) return;
  stop_.store(true);
  thread_.join();
}

void RetainThread::loop() noexcept {
  while (!stop_.load()) {
    pass(monotonic_ns(), false);
    std::this_thread::sleep_for(kLookEvery);
  }
  pass(monotonic_ns(), true);
}

void RetainThread::pass(std::int64_t now_ns, bool last) noexcept {
  for (Item& item : items_) look_at(item, now_ns, last);
}

void RetainThread::look_at(Item& item, std::int64_t now_ns, bool last) noexcept {
  RetainLink& link = item.station->retain();
  if (link.blocks.update()) item.unsaved = true;
  if (!item.unsaved) return;
  const bool urgent =
      link.urgent_scan.load(std::memory_order_acquire) > link.saved_scan.load(std::memory_order_relaxed);
  const bool patient = item.failing || !urgent;  // a full disk is not hammered
  if (patient && !last && now_ns - item.last_save_ns < interval_ns_) return;
  save(item, now_ns);
}

void RetainThread::save(Item& item, std::int64_t now_ns) {
  RetainLink& link = item.station->retain();
  const ConstBlockView block{link.blocks.readable(), link.tags.layout};
  item.last_save_ns = now_ns;
  if (!item.target->save(item.station->epoch(), block.slots())) {
    if (!item.failing)
      log_(3, "station " + item.station->name() + ": retained tags are not written: " + item.target->error());
    item.failing = true;
    // still unsaved: tried again after the interval; an urgent ticket stays open, so the program waits
    return;
  }
  if (item.failing) log_(1, "station " + item.station->name() + ": retained tags are written again");
  item.failing = false;
  item.unsaved = false;
  link.saved_scan.store(block.header().scan, std::memory_order_release);
}

}  // namespace stationd

#include "supervisor/pieces.hpp"

#include <algorithm>

namespace stationd::supervisor {

EpochCount* PieceCount::find(std::uint32_t epoch) {
  const auto it = std::ranges::find(epochs, epoch, &EpochCount::epoch);
  return it == epochs.end() ? nullptr : &*it;
}

EpochCount& PieceCount::append(std::uint32_t epoch, std::uint32_t last_seq) {
  if (epochs.size() == kEpochs) epochs.erase(epochs.begin());
  return epochs.emplace_back(EpochCount{epoch, last_seq});
}

void PieceCount::begin(std::uint32_t epoch) {
  if (find(epoch) == nullptr) append(epoch, 0);
}

bool PieceCount::add(const bus::End& end) {
  if (end.SEQ == 0) return end.EPOCH == 0 && add_plain(end);
  EpochCount* known = find(end.EPOCH);
  if (known == nullptr) known = &append(end.EPOCH, epochs.empty() ? end.SEQ - 1 : 0);
  if (end.SEQ <= known->last_seq) return false;
  missed += end.SEQ - known->last_seq - 1;
  known->last_seq = end.SEQ;
  ++counted;
  if (end.ERROR) ++faulty;
  return true;
}

bool PieceCount::add_plain(const bus::End& end) {
  if (end.CODE == 0) return false;
  if (end.CODE == plain_code && end.ERROR == plain_error && end.STATUS == plain_status) return false;
  plain_code = end.CODE;
  plain_error = end.ERROR;
  plain_status = end.STATUS;
  ++counted;
  if (end.ERROR) ++faulty;
  return true;
}

}  // namespace stationd::supervisor

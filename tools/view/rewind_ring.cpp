#include "view/rewind_ring.h"

#include <algorithm>
#include <utility>

namespace mallow::view {

std::size_t bytes_of(const SavedState& state) {
  std::size_t bytes = 0;
  for (const Chunk& chunk : state.chunks) bytes += chunk.bytes.size() + chunk.name.size();
  return bytes;
}

void RewindRing::add(Moment moment) {
  while (!moments_.empty() && moments_.back().step >= moment.step) {
    bytes_ -= bytes_of(moments_.back().state);
    moments_.pop_back();
  }
  bytes_ += bytes_of(moment.state);
  moments_.push_back(std::move(moment));
  while (bytes_ > budget_ && moments_.size() > 2) thin_out();
}

std::size_t RewindRing::find(double time) const {
  const auto later = std::ranges::find_if(moments_, [&](const Moment& moment) { return moment.time > time; });
  return later == moments_.begin() ? 0 : static_cast<std::size_t>(later - moments_.begin()) - 1;
}

void RewindRing::clear() {
  moments_.clear();
  bytes_ = 0;
}

void RewindRing::thin_out() {
  std::deque<Moment> kept;
  // The first one stays: it is the scene's beginning.
  const std::size_t old = std::max<std::size_t>(2, moments_.size() / 2);
  for (std::size_t k = 0; k < moments_.size(); ++k)
    if (k >= old || k % 2 == 0) kept.push_back(std::move(moments_[k]));
  moments_ = std::move(kept);
  bytes_ = 0;
  for (const Moment& moment : moments_) bytes_ += bytes_of(moment.state);
}

}  // namespace mallow::view

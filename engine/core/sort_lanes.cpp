// The scan of a counting sort, eight keys at a time.
#include "core/sort_lanes.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// Lane l: the sum of the lanes up to it.
MALLOW_INLINE Ints running_sums(Ints v) {
  const Ints none = {};
  v += shuffled<0, 8, 9, 10, 11, 12, 13, 14>(none, v);
  v += shuffled<0, 0, 8, 9, 10, 11, 12, 13>(none, v);
  return v + shuffled<0, 0, 0, 0, 8, 9, 10, 11>(none, v);
}

std::uint32_t counts_to_places(std::uint32_t* counts, std::size_t chunks, std::size_t keys, std::size_t first,
                               std::size_t last, std::uint32_t place, std::uint32_t* starts) noexcept {
  std::size_t key = first;
  for (; key + k_cluster <= last; key += k_cluster) {
    Ints total = {};
    for (std::size_t c = 0; c < chunks; ++c) total += load(counts + c * keys + key);
    const Ints behind = running_sums(total) + static_cast<int>(place);
    Ints next = behind - total;
    store(next, starts + key);
    for (std::size_t c = 0; c < chunks; ++c) {
      // Before the count is written over: GCC 12 loses a sum behind it with -fno-sanitize-recover=undefined.
      const Ints after = next + load(counts + c * keys + key);
      store(next, counts + c * keys + key);
      next = after;
    }
    place = static_cast<std::uint32_t>(behind[k_cluster - 1]);
  }
  for (; key < last; ++key) {
    starts[key] = place;
    for (std::size_t c = 0; c < chunks; ++c) {
      const std::uint32_t here = counts[c * keys + key];
      counts[c * keys + key] = place;
      place += here;
    }
  }
  return place;
}

}  // namespace

extern const SortLanes sort_lanes;
const SortLanes sort_lanes = {counts_to_places};

}  // namespace mallow::MALLOW_LEVEL

#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"

namespace mallow {

struct SortLanes {
  /// Counts of the items of the keys [first, last), one per chunk of items and those of chunks `keys` apart,
  /// become places from `place` on: key by key, and chunk by chunk within a key. starts: by key, the first of
  /// its places. Returns the place behind the last.
  std::uint32_t (*counts_to_places)(std::uint32_t* counts, std::size_t chunks, std::size_t keys,
                                    std::size_t first, std::size_t last, std::uint32_t place,
                                    std::uint32_t* starts) noexcept;
};
MALLOW_DECLARE_LEVELS(SortLanes, sort_lanes)

}  // namespace mallow

#pragma once

#include "neighbors/search_lanes.h"

namespace mallow {

struct GridLanes {
  /// The cells of points, `begin` up to `end`, into `cells` from `begin` on. Monotone in each coordinate, so
  /// that what lies between two coordinates lies in the cells between theirs, also where they are clamped:
  /// cells at the border hold what lies beyond, and those at 0 what is not a number. Reads no sorted points.
  void (*cells_of)(const SearchInput&, ConstVectors points, std::size_t begin, std::size_t end,
                   std::uint32_t* cells) noexcept;
};
MALLOW_DECLARE_LEVELS(GridLanes, grid_lanes)

}  // namespace mallow

#pragma once

#include "neighbors/search_kernel.h"

namespace mallow {

struct GridKernels {
  /// The cells of points, `begin` up to `end`, into `cells` from `begin` on. Monotone in each coordinate, so
  /// that what lies between two coordinates lies in the cells between theirs, also where they are clamped:
  /// cells at the border hold what lies beyond, and those at 0 what is not a number. Reads no sorted points.
  void (*cells_of)(const SearchInput&, ConstVectors points, std::size_t begin, std::size_t end,
                   std::uint32_t* cells) noexcept;
  /// Counts of the points of the cells [first, last), one per chunk of points and those of chunks `cells`
  /// apart, become places from `place` on: cell by cell, and chunk by chunk within a cell. starts: by cell,
  /// the first of its places. Returns the place behind the last.
  std::uint32_t (*counts_to_places)(std::uint32_t* counts, std::size_t chunks, std::size_t cells,
                                    std::size_t first, std::size_t last, std::uint32_t place,
                                    std::uint32_t* starts) noexcept;
};
MALLOW_DECLARE_LEVELS(GridKernels, grid_kernels)

}  // namespace mallow

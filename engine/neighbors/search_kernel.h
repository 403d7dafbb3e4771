#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"

namespace mallow {

/// Sorted points and their cells, as CellGrid holds them.
struct SearchInput {
  ConstVectors sorted;
  const std::uint32_t* cell_start;
  int dims[3];
  float squared_radius;
};

struct SearchKernels {
  /// Points in and around the cell with coordinates `cell`: the most that a list of one of its points can
  /// hold.
  std::size_t (*candidates)(const SearchInput&, const int* cell);
  /// Writes the lists of the points [begin, end) of one cell behind each other to `out`, which has room for
  /// candidates() entries a point, and their lengths to `count`; returns the number of entries written.
  std::size_t (*search)(const SearchInput&, const int* cell, std::size_t begin, std::size_t end,
                        std::uint32_t* out, std::uint32_t* count);
};
MALLOW_DECLARE_LEVELS(SearchKernels, search_kernels)

}  // namespace mallow

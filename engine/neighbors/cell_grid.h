#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/column.h"

namespace mallow {

/// Points sorted into cubic cells that are no smaller than a search radius, so that all points within the
/// radius of a point are in its cell and the 26 around it. Cells are counted x fastest: three cells in a row
/// are one run. Points outside the covered box are counted to the nearest cell of its border, which keeps the
/// search right however far a point strays, and memory bounded.
struct CellGrid {
  Vec3 origin{0, 0, 0};
  float inverse_cell = 0;            ///< [1/m]
  std::array<int, 3> dims{0, 0, 0};  ///< cells per axis
  Column<std::uint32_t> cell_start;  ///< cells + 1: first sorted point of each cell
  Column<std::uint32_t> order;       ///< point of each sorted place
  VectorColumn sorted;               ///< positions in sorted order [m]

  // Scratch of the sort.
  Column<std::uint32_t> cell_of;
  Column<std::uint32_t> counts;
  std::vector<Aabb> partial_bounds;

  std::size_t bytes() const {
    return cell_start.bytes() + order.bytes() + sorted.bytes() + cell_of.bytes() + counts.bytes();
  }
};

/// Count, scan, scatter: a stable sort, the same for any number of threads. positions: finite. radius: > 0.
void build_cell_grid(const VectorColumn& positions, std::size_t begin, std::size_t end, float radius,
                     int threads, CellGrid& grid);

}  // namespace mallow

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/column.h"
#include "core/counting_sort.h"
#include "core/execution.h"
#include "core/isa.h"
#include "mallow/export.h"

namespace mallow {

/// Points sorted into the cells of a box, x fastest: the cells of one y and z are a pillar of the grid, and
/// its points from any x to any other are consecutive. Pillars are two spacings wide and cells half a spacing
/// long, so that eight consecutive points of a pillar, a cluster, lie in about a cube of two spacings. Points
/// outside of the covered box are counted to the nearest cell of its border, which keeps searches right
/// however far a point strays, and memory bounded.
struct CellGrid {
  /// Typical distance of a point from the next [m], which the size of the cells follows; 0: half the radius.
  /// Sets how fast searches are, not what they find.
  float spacing = 0;
  /// Cells lie on a lattice that stays where it is. In which order lists have their points then depends on
  /// these alone, not on how far all points reach.
  bool anchored = false;
  /// Points that are left out, as they sleep, but count where the size of cells is chosen: it changes with
  /// none that falls asleep.
  std::size_t points_beside = 0;
  Aabb box_beside;  ///< around them [m]

  Vec3 origin{0, 0, 0};                 ///< corner of the covered box [m]
  float along = 0, across = 0;          ///< edges of a cell: in x, and in y and z [m]
  float rounding = 0;                   ///< bound of what coordinates within the box are off by [m]
  std::array<int, 3> dims{0, 0, 0};     ///< cells per axis
  Vec3 cells_from{0, 0, 0};             ///< where cells are counted from: the origin, or 0 if anchored [m]
  std::array<int, 3> first{0, 0, 0};    ///< the first cell, counted from there
  Column<std::uint32_t> cell_start;     ///< cells + 1: first sorted point of each cell
  Column<std::uint32_t> order;          ///< point of each sorted place
  VectorColumn sorted;                  ///< positions in sorted order [m]
  Column<std::uint32_t> cluster_start;  ///< clusters + 1: first sorted point of each cluster

  // Scratch.
  Column<std::uint32_t> cell_of;
  CountingSort sort;
  std::vector<std::uint32_t> block_sums;
  std::vector<Aabb> partial_bounds;

  std::size_t pillars() const {
    return static_cast<std::size_t>(dims[1]) * static_cast<std::size_t>(dims[2]);
  }
  std::size_t clusters() const { return cluster_start.size() - 1; }
  std::size_t bytes() const {
    return cell_start.bytes() + order.bytes() + sorted.bytes() + cluster_start.bytes() + cell_of.bytes() +
           sort.bytes();
  }
};

/// Count, scan, scatter: a stable sort, the same for any number of threads. positions: finite. radius: > 0,
/// the largest that will be searched for.
MALLOW_EXPORT void build_cell_grid(const VectorColumn& positions, std::size_t begin, std::size_t end,
                                   float radius, const Execution& execution, CellGrid& grid);

}  // namespace mallow

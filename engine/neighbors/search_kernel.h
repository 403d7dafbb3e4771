#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"

namespace mallow {

/// Sorted points, their cells and clusters, as CellGrid holds them.
struct SearchInput {
  ConstVectors sorted;
  const std::uint32_t* cell_start;
  const std::uint32_t* cluster_start;
  float origin[3];
  float edge[3];          ///< of a cell
  float inverse_edge[3];  ///< 1/edge
  int dims[3];
  float squared_radius;
  float reach;  ///< the radius, and what coordinates may be off by
};

struct Bounds {
  float low[3], high[3];
};

/// Sorted points [begin, end).
struct PlaceRun {
  std::uint32_t begin, end;
};

struct SearchKernels {
  /// The box of a cluster's points.
  Bounds (*box_of)(const SearchInput&, std::size_t cluster) noexcept;
  /// Runs of points that hold all whose distance from the box is at most the radius, ascending; returns how
  /// many. runs: room for one a column of the grid.
  std::size_t (*find_runs)(const SearchInput&, const Bounds& box, PlaceRun* runs) noexcept;
  /// Of the points in these runs those within the radius of the box, ascending; returns how many. None that
  /// is within the radius of a point in the box is left out. out: room for all of the runs'
  /// points and k_cluster more.
  std::size_t (*near_cluster)(const SearchInput&, const Bounds& box, const PlaceRun* runs, std::size_t count,
                              std::uint32_t* out) noexcept;
  /// Of n points, given by their places and coordinates, those within the radius of a sorted point, in order;
  /// returns how many. out: room for n + k_cluster.
  std::size_t (*near_point)(const SearchInput&, std::size_t point, std::size_t n, const std::uint32_t* places,
                            ConstVectors coordinates, std::uint32_t* out) noexcept;
};
MALLOW_DECLARE_LEVELS(SearchKernels, search_kernels)

}  // namespace mallow

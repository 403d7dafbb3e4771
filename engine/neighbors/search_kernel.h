#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"
#include "mallow/export.h"

namespace mallow {

/// Columns of a grid lie in strips of this many, each as long as the grid in z: what a cluster's neighbours
/// lie in stays in the cache from one column to the next where a whole slice of the grid would not.
inline constexpr int k_strip = 8;

/// Place of a column among all. Static, so that every kernel file has its own (core/isa.h).
static inline std::size_t column_of(const int* dims, int y, int z) {
  const int strip = y / k_strip, rest = dims[1] - strip * k_strip, width = rest < k_strip ? rest : k_strip;
  return static_cast<std::size_t>(strip * k_strip) * static_cast<std::size_t>(dims[2]) +
         static_cast<std::size_t>(z) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(y % k_strip);
}

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

struct CellGrid;
/// What searches of a grid within a radius read. radius: at most the one that the grid was built for.
MALLOW_EXPORT SearchInput search_input(const CellGrid& grid, float radius);

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
  /// Runs of points that hold all whose distance from the box is at most the radius; returns how
  /// many. runs: room for one a column of the grid.
  std::size_t (*find_runs)(const SearchInput&, const Bounds& box, PlaceRun* runs) noexcept;
  /// Of the points in these runs those within the radius of the box, in order; returns how many. None that
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

#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"
#include "mallow/export.h"

namespace mallow {

/// Pillars of a grid lie in strips of this many, each as long as the grid in z: what a cluster's neighbours
/// lie in stays in the cache from one pillar to the next where a whole slice of the grid would not.
inline constexpr int k_strip = 8;

/// Place of a pillar among all. Static, so that every file of lanes has its own (core/isa.h).
static inline std::size_t pillar_of(const int* dims, int y, int z) {
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
  float cells_from[3];  ///< where cells are counted from: the origin, or 0 in a grid that is anchored
  int first[3];         ///< the first cell, counted from there
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
struct PlaceRange {
  std::uint32_t begin, end;
};

struct SearchLanes {
  /// The box of a cluster's points.
  Bounds (*box_of)(const SearchInput&, std::size_t cluster) noexcept;
  /// Ranges of points that hold all whose distance from the box is at most the radius; returns how
  /// many. ranges: room for one a pillar of the grid.
  std::size_t (*find_ranges)(const SearchInput&, const Bounds& box, PlaceRange* ranges) noexcept;
  /// Of the points in these ranges those within the radius of the box, in order; returns how many. None that
  /// is within the radius of a point in the box is left out. out: room for all of the ranges'
  /// points and k_cluster more.
  std::size_t (*near_cluster)(const SearchInput&, const Bounds& box, const PlaceRange* ranges,
                              std::size_t count, std::uint32_t* out) noexcept;
  /// Of n points, given by their places and coordinates, those within the radius of a sorted point, in order;
  /// returns how many. out: room for n + k_cluster.
  std::size_t (*near_point)(const SearchInput&, std::size_t point, std::size_t n, const std::uint32_t* places,
                            ConstVectors coordinates, std::uint32_t* out) noexcept;
};
MALLOW_DECLARE_LEVELS(SearchLanes, search_lanes)

}  // namespace mallow

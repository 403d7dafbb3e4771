#pragma once

#include <cstddef>
#include <cstdint>

#include "core/isa.h"
#include "surface/cell_lanes.h"

namespace mallow {

/// Room behind a list of cells: they are taken in eights.
inline constexpr std::size_t k_list_room = 8;
/// The most vertices that a block's cells have.
inline constexpr std::size_t k_most_vertices = 4 * k_block_voxels;

/// A block whose vertices are placed.
struct VertexBlock {
  const float* distances[27];  ///< of the blocks around it, by neighbor_slot(): 512 each, z fastest
  BitRange range;              ///< of its cells with vertices
  double first[3];             ///< its first voxel [voxels]
  double origin[3];            ///< [m]
  double voxel_size;           ///< [m]
};

/// The cells of a block's vertices, 64 x + 8 y + z, with k_list_room more that may be any.
struct VertexList {
  std::size_t count;
  const std::uint16_t* cells;
  /// The edges of each vertex, a bit each, where some cells have more than one; else none.
  const std::uint16_t* edges;
};

/// Where vertices go, three floats each.
struct VertexRows {
  float* local;     ///< [voxels] from the block's first voxel
  float* vertices;  ///< [m]
  float* normals;
};

/// Vertices of one block.
struct VertexLanes {
  /// Each vertex goes to the mean of where the surface cuts its edges; its normal is the direction in which
  /// distances grow there.
  void (*place_vertices)(const VertexBlock&, const VertexList&, const VertexRows&) noexcept;
};
MALLOW_DECLARE_LEVELS(VertexLanes, vertex_lanes)

}  // namespace mallow

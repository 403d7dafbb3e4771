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
  const BlockBits* cut;        ///< its cells with vertices
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

/// A cell with more than one patch.
struct PatchedCell {
  std::uint16_t cell;     ///< 64 x + 8 y + z
  std::uint16_t patches;  ///< which of k_cell_patches
};

/// A block whose quads are written.
struct QuadBlock {
  /// A block that has some of the cells around the edges.
  struct Cells {
    const std::uint16_t* vertex;  ///< first one of each cell that is cut, from the block's first on; or none
    std::uint32_t first_vertex;
    const PatchedCell* patched;
    std::size_t patched_count;
  };
  Cells around[8];  ///< number 4 dx + 2 dy + dz lies at an offset of (dx, dy, dz) − 1
  const BlockBits* inside;
  const BlockBits* edges;             ///< that are cut, along each axis
  const std::uint8_t* patch_of_edge;  ///< k_patch_of_edge
  const float* local;                 ///< of all vertices, three floats each, and one float more
  std::uint32_t first_in_mesh;        ///< added to all vertices
};

/// Vertices and quads of one block at a time.
struct MeshLanes {
  /// Each vertex goes to the mean of where the surface cuts its edges; its normal is the direction in which
  /// distances grow there.
  void (*place_vertices)(const VertexBlock&, const VertexList&, const VertexRows&) noexcept;
  /// Two triangles for each edge that is cut, counter-clockwise seen from outside, in the order of cells and
  /// axes.
  void (*write_quads)(const QuadBlock&, std::uint32_t* triangles) noexcept;
};
MALLOW_DECLARE_LEVELS(MeshLanes, mesh_lanes)

}  // namespace mallow

#pragma once

#include <cstddef>
#include <cstdint>

#include "core/isa.h"
#include "surface/cell_lanes.h"

namespace mallow {

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
  BitRange range;                     ///< of the cells that are cut
  const BlockBits* edges;             ///< that are cut, along each axis
  const std::uint8_t* patch_of_edge;  ///< k_patch_of_edge
  const float* local;                 ///< of all vertices, three floats each, and one float more
  std::uint32_t first_in_mesh;        ///< added to all vertices
};

/// Quads of one block.
struct QuadLanes {
  /// Two triangles for each edge that is cut, counter-clockwise seen from outside, in the order of cells and
  /// axes.
  void (*write_quads)(const QuadBlock&, std::uint32_t* triangles) noexcept;
};
MALLOW_DECLARE_LEVELS(QuadLanes, quad_lanes)

}  // namespace mallow

#pragma once

#include <cstddef>
#include <cstdint>

#include "core/isa.h"
#include "surface/voxel_frame.h"

namespace mallow {

/// A bit for each voxel of a block, or for the cell whose lowest corner it is: bit 8 y + z of word x.
struct BlockBits {
  std::uint64_t at[k_block_side];
};
/// Which corners of a block's cells are inside, along y and z: at[2 dy + dz][x], bit 8 y + z, is voxel
/// (x, y + dy, z + dz).
struct CornerBits {
  std::uint64_t at[4][k_block_side + 1];
};
/// The first and the last x and y that bits of a block have.
struct BitRange {
  int first_x, last_x, first_y, last_y;
};
/// What the signs of voxels tell of a block's cells. Where no cell is cut, only `cut`, `cells` and `quads`
/// are set.
struct CellBits {
  BlockBits cut;               ///< cells with corners on both sides
  BlockBits edges[3];          ///< edges from the lowest corner along an axis that are cut
  BlockBits unclear;           ///< holds all cells that may have more than one patch, and some others
  BitRange range;              ///< of the cells that are cut
  std::uint32_t cells, quads;  ///< how many cells and edges are cut
};

/// Signs of voxels and cells, 64 at a time.
struct CellLanes {
  /// inside: where distances are below 0.
  void (*find_signs)(const float* distances, BlockBits& inside) noexcept;
  /// inside: of the block and those above it, number 4 dx + 2 dy + dz of those at an offset of (dx, dy, dz).
  void (*find_cells)(const BlockBits* const* inside, CornerBits& corners, CellBits& cells) noexcept;
  /// Lists the cells that are cut, 64 x + 8 y + z, and sets their places in the list. Returns how many.
  std::size_t (*list_cells)(const BlockBits& cut, std::uint16_t* list, std::uint16_t* place) noexcept;
};
MALLOW_DECLARE_LEVELS(CellLanes, cell_lanes)
/// Those of best_instruction_level().
const CellLanes& best_cell_lanes();

}  // namespace mallow

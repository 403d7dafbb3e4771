#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/threads.h"
#include "surface/cell_lanes.h"
#include "surface/dual_cells.h"
#include "surface/quad_lanes.h"
#include "surface/surface_field.h"
#include "surface/vertex_lanes.h"

namespace mallow {

inline std::size_t cell_at(int x, int y, int z) {
  return static_cast<std::size_t>((x * k_block_side + y) * k_block_side + z);
}

/// What the cells of a block hold; a cell has its lowest voxel in the block.
struct BlockCells {
  CellBits bits;
  /// First vertex of each cell that is cut, from the block's first on; null where none is.
  std::uint16_t* vertex;
  std::vector<PatchedCell> patched;  ///< those with more than one vertex, in order
  /// Places among CutCells::blocks() of the block itself and those below it, number 4 dx + 2 dy + dz of one
  /// at an offset of (dx, dy, dz) − 1; k_no_block where it has no cells. Set where there are quads.
  std::array<std::uint32_t, 8> around;
  std::uint32_t first_vertex, vertices, first_quad;

  bool is_cut(std::size_t cell) const { return (bits.cut.at[cell / 64] >> (cell % 64) & 1) != 0; }
};

/// A corner of a quad.
struct QuadCorner {
  std::uint32_t vertex;
  std::uint32_t at;       ///< place of its block among CutCells::blocks()
  std::size_t cell;       ///< in that block
  Eigen::Vector3i block;  ///< that block's offset from the quad's, in blocks
};

/// The vertices of a block's cells, in order.
struct CellList {
  std::array<std::uint16_t, k_most_vertices + k_list_room> cells, edges;
  VertexList vertices;  ///< points to them
};

/// The cells between eight voxels that the zero of a level set cuts: a vertex for each patch of surface in
/// them and a quad for each edge that is cut (dual marching cubes, Nielson 2004; closed and manifold after
/// Wenger 2013, 3.3, whatever the distances are). Vertices and quads are numbered block by block. Keeps its
/// memory from one frame to the next.
class CutCells {
 public:
  void find(const SurfaceField& field, const Threads& threads);
  /// Which corners of a block's cells are inside, a bit each.
  void find_corners(const SurfaceField& field, std::size_t at,
                    std::array<std::uint8_t, k_block_voxels>& inside) const;

  /// Blocks with a cell that may be cut, by their numbers in the field.
  const std::vector<std::uint32_t>& blocks() const { return blocks_; }
  const BlockCells& cells(std::size_t at) const { return cells_[at]; }
  std::uint32_t vertices() const { return vertices_; }
  std::uint32_t quads() const { return quads_; }

  /// Lists the vertices of a block, and numbers them in BlockCells::vertex.
  void list_vertices(std::size_t at, CellList& list);
  /// What the quads of a block are written from, but for vertices.
  QuadBlock quad_block(std::size_t at) const;

  /// Calls visit(cell, x, y, z) for the cells of a block that are cut.
  template <class Visit>
  void for_each_cut(std::size_t at, const Visit& visit) const;
  /// Calls visit(std::array<QuadCorner, 4>) for the edges that are cut and start at a voxel of the block,
  /// with the cells around them counter-clockwise seen from outside; in the order of QuadLanes::write_quads.
  template <class Visit>
  void for_each_quad(std::size_t at, const Visit& visit) const;

  std::size_t bytes() const;

 private:
  void choose_blocks(const SurfaceField& field);
  const BlockBits& signs(const SurfaceField& field, std::uint32_t block) const;
  void find_signs(const SurfaceField& field, std::size_t at);
  void find_bits(const SurfaceField& field, std::size_t at, CornerBits& corners, CellBits& bits) const;
  void find_cells(const SurfaceField& field, std::size_t at);
  void find_patched(const SurfaceField& field, std::size_t at, const CornerBits& corners);
  unsigned corners_beside(const SurfaceField& field, std::size_t at, const CornerBits& corners, int x, int y,
                          int z, int face) const;
  std::uint32_t vertex_at_edge(std::uint32_t at, std::size_t cell, int edge) const;

  std::vector<std::uint32_t> blocks_;
  std::vector<std::uint32_t> place_;  ///< of each block of the field among them
  // What all blocks beside a block look at is kept apart from what few do.
  std::vector<BlockBits> inside_;  ///< voxels of each
  std::vector<BlockCells> cells_;
  std::vector<std::array<std::uint16_t, k_block_voxels>> numbers_;  ///< of vertices, of blocks that have any
  std::uint32_t vertices_ = 0, quads_ = 0;
};

template <class Visit>
void CutCells::for_each_cut(std::size_t at, const Visit& visit) const {
  for (int x = 0; x < k_block_side; ++x) {
    for (std::uint64_t left = cells_[at].bits.cut.at[x]; left != 0; left &= left - 1) {
      const int bit = std::countr_zero(left);
      visit(cell_at(x, 0, bit), x, bit / k_block_side, bit % k_block_side);
    }
  }
}

template <class Visit>
void CutCells::for_each_quad(std::size_t at, const Visit& visit) const {
  const BlockCells& cells = cells_[at];
  if (cells.bits.quads == 0) return;
  for_each_cut(at, [&](std::size_t cell, int x, int y, int z) {
    for (int axis = 0; axis < 3; ++axis) {
      const int bit = y * k_block_side + z;
      if ((cells.bits.edges[axis].at[x] >> bit & 1) == 0) continue;
      // The cells around the edge, counter-clockwise seen from where it leads.
      constexpr int k_around[4][2] = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};
      constexpr int k_steps[3] = {k_block_side * k_block_side, k_block_side, 1};
      const int u_axis = (axis + 1) % 3, v_axis = (axis + 2) % 3;
      const int at_u = u_axis == 0 ? x : u_axis == 1 ? y : z, at_v = v_axis == 0 ? x : v_axis == 1 ? y : z;
      std::array<QuadCorner, 4> quad;
      for (std::size_t k = 0; k < 4; ++k) {
        const int u = k_around[k][0], v = k_around[k][1];
        Eigen::Vector3i block(0, 0, 0);
        block[u_axis] = u > at_u ? -1 : 0;
        block[v_axis] = v > at_v ? -1 : 0;
        const auto there = static_cast<std::size_t>(static_cast<int>(cell) -
                                                    (u + k_block_side * block[u_axis]) * k_steps[u_axis] -
                                                    (v + k_block_side * block[v_axis]) * k_steps[v_axis]);
        const std::uint32_t of =
            cells.around[static_cast<std::size_t>(7 + 4 * block.x() + 2 * block.y() + block.z())];
        // Where the edge leads inside, counter-clockwise is the other way round.
        const std::size_t corner = inside_[at].at[x] >> bit & 1 ? k : (4 - k) % 4;
        quad[corner] = {vertex_at_edge(of, there, 4 * axis + 2 * u + v), of, there, block};
      }
      visit(quad);
    }
  });
}

}  // namespace mallow

#include "surface/cut_cells.h"

#include <algorithm>

#include "core/parallel.h"

namespace mallow {
namespace {

constexpr BlockBits all_bits(std::uint64_t word) {
  BlockBits bits{};
  for (std::uint64_t& slice : bits.at) slice = word;
  return bits;
}
constexpr BlockBits k_outside = all_bits(0), k_inside = all_bits(UINT64_MAX);

/// Neighbour slots of a block and those below it, at an offset of (dx, dy, dz) − 1, and of those above it, at
/// one of (dx, dy, dz), both by 4 dx + 2 dy + dz.
constexpr std::array<std::size_t, 8> k_slots_below = {0, 1, 3, 4, 9, 10, 12, 13},
                                     k_slots_above = {13, 14, 16, 17, 22, 23, 25, 26};

/// The corners of a cell that are inside, a bit each.
unsigned corners_of(const CornerBits& corners, int x, int y, int z) {
  unsigned inside = 0;
  for (int c = 0; c < 8; ++c)
    inside |= static_cast<unsigned>(corners.at[c & 3][x + (c >> 2)] >> (y * k_block_side + z) & 1) << c;
  return inside;
}

}  // namespace

const CellLanes& best_cell_lanes() {
  static const InstructionLevel level = best_instruction_level();
  return MALLOW_SELECT(level, cell_lanes);
}

/// Surface blocks, and those below them, whose last cells reach into one.
void CutCells::choose_blocks(const SurfaceField& field) {
  const auto n = static_cast<std::uint32_t>(field.blocks().size());
  blocks_.clear();
  place_.assign(n, k_no_block);
  for (std::uint32_t b = 0; b < n; ++b) {
    if (field.kind(b) != BlockKind::surface) continue;
    for (const std::size_t slot : k_slots_below)
      if (const std::uint32_t other = field.neighbors(b)[slot]; other != k_no_block) place_[other] = 0;
  }
  for (std::uint32_t b = 0; b < n; ++b) {
    if (place_[b] == k_no_block) continue;
    place_[b] = static_cast<std::uint32_t>(blocks_.size());
    blocks_.push_back(b);
  }
}

void CutCells::find_signs(const SurfaceField& field, std::size_t at) {
  const std::uint32_t block = blocks_[at];
  if (field.kind(block) == BlockKind::surface)
    inside_[at] = field.signs(block);
  else
    inside_[at] = field.kind(block) == BlockKind::inside ? k_inside : k_outside;
}

/// Of the voxels of any block of the field, or of none.
const BlockBits& CutCells::signs(const SurfaceField& field, std::uint32_t block) const {
  if (block == k_no_block) return k_outside;
  if (const std::uint32_t at = place_[block]; at != k_no_block) return inside_[at];
  return field.kind(block) == BlockKind::inside ? k_inside : k_outside;
}

void CutCells::find_bits(const SurfaceField& field, std::size_t at, CornerBits& corners,
                         CellBits& bits) const {
  const BlockBits* inside[8];
  for (std::size_t k = 0; k < 8; ++k)
    inside[k] = &signs(field, field.neighbors(blocks_[at])[k_slots_above[k]]);
  best_cell_lanes().find_cells(inside, corners, bits);
}

/// Corners inside of the cell beside one at a face.
unsigned CutCells::corners_beside(const SurfaceField& field, std::size_t at, const CornerBits& corners, int x,
                                  int y, int z, int face) const {
  const int axis = face / 2, step = face % 2 ? 1 : -1;
  Eigen::Vector3i cell(x, y, z), block(0, 0, 0);
  cell[axis] += step;
  if (cell[axis] >= 0 && cell[axis] < k_block_side) return corners_of(corners, cell.x(), cell.y(), cell.z());
  block[axis] = step;
  cell[axis] &= k_block_side - 1;
  CornerBits there;
  CellBits unused;
  const std::uint32_t other = field.neighbors(blocks_[at])[neighbor_slot(block.x(), block.y(), block.z())];
  find_bits(field, place_[other], there, unused);
  return corners_of(there, cell.x(), cell.y(), cell.z());
}

/// Decides which patches of ambiguous cells are joined, lists the cells that have more than one, and counts
/// the vertices of these.
void CutCells::find_patched(const SurfaceField& field, std::size_t at, const CornerBits& corners) {
  BlockCells& cells = cells_[at];
  for (int x = 0; x < k_block_side; ++x) {
    for (std::uint64_t left = cells.bits.unclear.at[x]; left != 0; left &= left - 1) {
      const int bit = std::countr_zero(left), y = bit / k_block_side, z = bit % k_block_side;
      unsigned patches = corners_of(corners, x, y, z);
      if (const int face = k_cell_patches[patches].twice; face >= 0) {
        const unsigned other = corners_beside(field, at, corners, x, y, z, face);
        if (k_cell_patches[other].twice == (face ^ 1)) patches += 256;
      }
      const int count = k_cell_patches[patches].count;
      if (count == 1) continue;
      cells.patched.push_back(
          {static_cast<std::uint16_t>(cell_at(x, y, z)), static_cast<std::uint16_t>(patches)});
      cells.vertices += static_cast<std::uint32_t>(count - 1);
    }
  }
}

void CutCells::find_cells(const SurfaceField& field, std::size_t at) {
  CornerBits corners;
  BlockCells& cells = cells_[at];
  find_bits(field, at, corners, cells.bits);
  cells.patched.clear();
  cells.vertices = cells.bits.cells;
  if (cells.vertices == 0) return;
  for (std::size_t k = 0; k < 8; ++k) {
    const std::uint32_t other = field.neighbors(blocks_[at])[k_slots_below[k]];
    cells.around[k] = other == k_no_block ? k_no_block : place_[other];
  }
  find_patched(field, at, corners);
}

void CutCells::find(const SurfaceField& field, const Threads& threads) {
  choose_blocks(field);
  inside_.resize(blocks_.size());
  cells_.resize(blocks_.size());
  const auto each = [&](const auto& work) {
    parallel_for(
        threads, blocks_.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t at = begin; at < end; ++at) work(at);
        },
        k_blocks_at_once);
  };
  each([&](std::size_t at) { find_signs(field, at); });
  each([&](std::size_t at) { find_cells(field, at); });
  vertices_ = quads_ = 0;
  std::size_t numbered = 0;
  for (BlockCells& cells : cells_) {
    cells.first_vertex = vertices_;
    cells.first_quad = quads_;
    vertices_ += cells.vertices;
    quads_ += cells.bits.quads;
    numbered += cells.vertices > 0 ? 1 : 0;
  }
  numbers_.resize(numbered);
  auto numbers = numbers_.begin();
  for (BlockCells& cells : cells_) cells.vertex = cells.vertices > 0 ? (numbers++)->data() : nullptr;
}

void CutCells::find_corners(const SurfaceField& field, std::size_t at,
                            std::array<std::uint8_t, k_block_voxels>& inside) const {
  CornerBits corners;
  CellBits unused;
  find_bits(field, at, corners, unused);
  for (int x = 0; x < k_block_side; ++x)
    for (int y = 0; y < k_block_side; ++y)
      for (int z = 0; z < k_block_side; ++z)
        inside[cell_at(x, y, z)] = static_cast<std::uint8_t>(corners_of(corners, x, y, z));
}

void CutCells::list_vertices(std::size_t at, CellList& list) {
  BlockCells& cells = cells_[at];
  std::size_t n = best_cell_lanes().list_cells(cells.bits.cut, list.cells.data(), cells.vertex);
  list.vertices = {cells.vertices, list.cells.data(), nullptr};
  if (!cells.patched.empty()) {
    // From the last cell on, as cells move up to make room for those that are there several times.
    std::size_t to = cells.vertices;
    auto next = cells.patched.rbegin();
    while (n > 0) {
      const std::uint16_t cell = list.cells[--n];
      const bool patched = next != cells.patched.rend() && next->cell == cell;
      const CellPatches& patches = k_cell_patches[patched ? next->patches : 0];
      for (int p = patched ? patches.count - 1 : 0; p >= 0; --p) {
        list.cells[--to] = cell;
        list.edges[to] = patched ? patches.edges[static_cast<std::size_t>(p)] : k_all_edges;
      }
      cells.vertex[cell] = static_cast<std::uint16_t>(to);
      if (patched) ++next;
    }
    list.vertices.edges = list.edges.data();
    std::fill_n(list.edges.begin() + cells.vertices, k_list_room, k_all_edges);
  }
  std::fill_n(list.cells.begin() + cells.vertices, k_list_room, list.cells[0]);
}

QuadBlock CutCells::quad_block(std::size_t at) const {
  const BlockCells& cells = cells_[at];
  QuadBlock block{};
  for (std::size_t k = 0; k < 8; ++k) {
    if (cells.around[k] == k_no_block) continue;
    const BlockCells& of = cells_[cells.around[k]];
    block.around[k] = {of.vertex, of.first_vertex, of.patched.data(), of.patched.size()};
  }
  block.inside = &inside_[at];
  block.range = cells.bits.range;
  block.edges = cells.bits.edges;
  block.patch_of_edge = k_patch_of_edge.at[0];
  return block;
}

/// The vertex of the patch that an edge of a cell belongs to.
std::uint32_t CutCells::vertex_at_edge(std::uint32_t at, std::size_t cell, int edge) const {
  const BlockCells& cells = cells_[at];
  const std::uint32_t first = cells.first_vertex + cells.vertex[cell];
  const auto patched =
      std::lower_bound(cells.patched.begin(), cells.patched.end(), cell,
                       [](const PatchedCell& of, std::size_t number) { return of.cell < number; });
  if (patched == cells.patched.end() || patched->cell != cell) return first;
  return first + k_patch_of_edge.at[patched->patches][edge];
}

std::size_t CutCells::bytes() const {
  std::size_t bytes = cells_.capacity() * sizeof(BlockCells) + inside_.capacity() * sizeof(BlockBits) +
                      numbers_.capacity() * sizeof numbers_[0] +
                      (blocks_.capacity() + place_.capacity()) * sizeof(std::uint32_t);
  for (const BlockCells& cells : cells_) bytes += cells.patched.capacity() * sizeof(PatchedCell);
  return bytes;
}

}  // namespace mallow

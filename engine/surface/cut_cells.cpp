#include "surface/cut_cells.h"

#include <bit>

#include "core/parallel.h"

namespace mallow {
namespace {

/// By the nine voxels of a row, a bit each: voxels z and z + 1 in byte z.
constexpr std::array<std::uint64_t, 512> k_pairs = [] {
  std::array<std::uint64_t, 512> pairs{};
  for (std::size_t row = 0; row < pairs.size(); ++row) {
    std::array<std::uint8_t, k_block_side> bytes{};
    for (std::size_t z = 0; z < bytes.size(); ++z) bytes[z] = static_cast<std::uint8_t>(row >> z & 3);
    pairs[row] = std::bit_cast<std::uint64_t>(bytes);
  }
  return pairs;
}();

}  // namespace

/// Surface blocks, and those below them, whose last cells reach into one.
void CutCells::choose_blocks(const SurfaceField& field) {
  const auto n = static_cast<std::uint32_t>(field.blocks().size());
  blocks_.clear();
  place_.assign(n, k_no_block);
  for (std::uint32_t b = 0; b < n; ++b) {
    bool cut = false;
    for (int x = 0; x <= 1; ++x)
      for (int y = 0; y <= 1; ++y)
        for (int z = 0; z <= 1; ++z) {
          const std::uint32_t above = field.neighbors(b)[neighbor_slot(x, y, z)];
          cut = cut || (above != k_no_block && field.kind(above) == BlockKind::surface);
        }
    if (!cut) continue;
    place_[b] = static_cast<std::uint32_t>(blocks_.size());
    blocks_.push_back(b);
  }
}

void CutCells::find_signs(const SurfaceField& field, std::size_t at) {
  const std::uint32_t block = blocks_[at];
  for (std::size_t k = 0; k < neighbors_[at].size(); ++k) {
    const std::uint32_t other = field.neighbors(block)[k];
    neighbors_[at][k] = other == k_no_block ? k_no_block : place_[other];
  }
  if (field.kind(block) != BlockKind::surface) {
    signs_[at].fill(field.kind(block) == BlockKind::inside ? 255 : 0);
    return;
  }
  const float* const distances = field.distances(block);
  for (std::size_t row = 0; row < signs_[at].size(); ++row) {
    unsigned bits = 0;
    for (std::size_t z = 0; z < k_block_side; ++z)
      bits |= (distances[row * k_block_side + z] < 0 ? 1u : 0u) << z;
    signs_[at][row] = static_cast<std::uint8_t>(bits);
  }
}

/// Which corners of a block's cells are inside.
void CutCells::find_corners(const SurfaceField& field, std::size_t at) {
  constexpr unsigned k_all = (1u << (k_block_side + 1)) - 1;
  // Nine voxels of nine by nine rows, a bit each.
  unsigned rows[k_block_side + 1][k_block_side + 1];
  for (int x = 0; x <= k_block_side; ++x) {
    for (int y = 0; y <= k_block_side; ++y) {
      const int row = x % k_block_side * k_block_side + y % k_block_side;
      const auto bits = [&](int bz) -> unsigned {
        const std::size_t slot = neighbor_slot(x / k_block_side, y / k_block_side, bz);
        if (const std::uint32_t other = neighbors_[at][slot]; other != k_no_block)
          return signs_[other][static_cast<std::size_t>(row)];
        const std::uint32_t block = field.neighbors(blocks_[at])[slot];
        return block != k_no_block && field.kind(block) == BlockKind::inside ? 255 : 0;
      };
      rows[x][y] = bits(0) | (bits(1) & 1) << k_block_side;
    }
  }
  for (int x = 0; x < k_block_side; ++x) {
    for (int y = 0; y < k_block_side; ++y) {
      std::uint8_t* const to = cells_[at].inside.data() + cell_at(x, y, 0);
      const unsigned a = rows[x][y], b = rows[x][y + 1], c = rows[x + 1][y], d = rows[x + 1][y + 1];
      if (a == b && a == c && a == d && (a == 0 || a == k_all)) {
        std::memset(to, a == 0 ? 0 : 255, k_block_side);
        continue;
      }
      // Corners 0 and 1 are voxels z and z + 1 of row (x, y), and so on.
      const std::uint64_t corners = k_pairs[a] | k_pairs[b] << 2 | k_pairs[c] << 4 | k_pairs[d] << 6;
      std::memcpy(to, &corners, sizeof corners);
    }
  }
}

/// Decides which patches of ambiguous cells are joined, and counts vertices and quads.
void CutCells::count(std::size_t at) {
  BlockCells& cells = cells_[at];
  cells.vertices = cells.quads = 0;
  for_each_cut(at, [&](std::size_t cell, int x, int y, int z) {
    const unsigned inside = cells.inside[cell];
    unsigned patches = inside;
    if (const int face = k_cell_patches[inside].twice; face >= 0) {
      const int axis = face / 2, step = face % 2 ? 1 : -1;
      Eigen::Vector3i other(x, y, z), block(0, 0, 0);
      other[axis] += step;
      if (other[axis] < 0 || other[axis] == k_block_side) block[axis] = step;
      other[axis] = (other[axis] + k_block_side) % k_block_side;
      const auto there = cell_at(other.x(), other.y(), other.z());
      if (k_cell_patches[cells_[neighbors_[at][neighbor_slot(block.x(), block.y(), block.z())]].inside[there]]
              .twice == (face ^ 1))
        patches += 256;
    }
    cells.patches[cell] = static_cast<std::uint16_t>(patches);
    cells.vertex[cell] = static_cast<std::uint16_t>(cells.vertices);
    cells.vertices += static_cast<std::uint32_t>(k_cell_patches[patches].count);
    for (int axis = 0; axis < 3; ++axis) cells.quads += cuts_edge(inside, axis);
  });
}

void CutCells::find(const SurfaceField& field, const Threads& threads) {
  choose_blocks(field);
  cells_.resize(blocks_.size());
  signs_.resize(blocks_.size());
  neighbors_.resize(blocks_.size());
  const auto each = [&](const auto& work) {
    parallel_for(
        threads, blocks_.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t at = begin; at < end; ++at) work(at);
        },
        k_blocks_at_once);
  };
  each([&](std::size_t at) { find_signs(field, at); });
  each([&](std::size_t at) { find_corners(field, at); });
  each([&](std::size_t at) { count(at); });
  vertices_ = quads_ = 0;
  for (BlockCells& cells : cells_) {
    cells.first_vertex = vertices_;
    cells.first_quad = quads_;
    vertices_ += cells.vertices;
    quads_ += cells.quads;
  }
}

std::size_t CutCells::bytes() const {
  return cells_.capacity() * sizeof(BlockCells) + signs_.capacity() * sizeof(SignRows) +
         neighbors_.capacity() * sizeof neighbors_[0] +
         (blocks_.capacity() + place_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace mallow

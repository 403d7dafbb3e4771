#include <cstddef>
#include <cstdint>

#include "surface/surface_field.h"

namespace mallow {

/// Sums at a block's own nodes.
const float* SurfaceField::sums_of(std::uint32_t block) const {
  static constexpr float k_none[k_sums * k_block_voxels / 8] = {};  // of blocks that no particle reaches
  return block == k_no_block ? k_none : node_sums_.data() + node_place_[block];
}

/// The nodes in and behind a block, two voxels apart, where they lie.
void SurfaceField::find_rows(std::uint32_t block, NodeRows& rows) const {
  constexpr std::size_t k_side = k_nodes - 1;
  rows.stride = k_side * k_side * k_side;
  const float* sums[8];
  for (int slot = 0; slot < 8; ++slot)
    sums[slot] = sums_of(neighbors_[block][neighbor_slot(slot >> 2, slot >> 1 & 1, slot & 1)]);
  for (std::size_t x = 0; x < k_nodes; ++x) {
    for (std::size_t y = 0; y < k_nodes; ++y) {
      const std::size_t slot = x / k_side * 4 + y / k_side * 2;
      const std::size_t first = (x % k_side * k_side + y % k_side) * k_side;
      rows.four[x * k_nodes + y] = sums[slot] + first;
      rows.fifth[x * k_nodes + y] = sums[slot + 1] + first;
    }
  }
}

/// The nodes in and around a block, four voxels apart: two of an axis are its own, one lies before, two
/// behind. nodes: room for the sums at all.
void SurfaceField::collect_rows(std::uint32_t block, NodeRows& rows, float* nodes) const {
  constexpr std::size_t k_all = k_nodes * k_nodes * k_nodes, k_own = 8;
  const float* sums[27];
  for (std::size_t slot = 0; slot < 27; ++slot) sums[slot] = sums_of(neighbors_[block][slot]);
  // Node k of an axis is node (k + 1) % 2 of the block (k + 1) / 2 − 1 away.
  const auto number = [](std::size_t x, std::size_t y, std::size_t z, std::size_t side, auto part) {
    return (part(x + 1) * side + part(y + 1)) * side + part(z + 1);
  };
  const auto in_block = [](std::size_t k) { return k / 2; };
  const auto in_nodes = [](std::size_t k) { return k % 2; };
  std::size_t to = 0;
  for (std::size_t x = 0; x < k_nodes; ++x) {
    for (std::size_t y = 0; y < k_nodes; ++y) {
      rows.four[x * k_nodes + y] = nodes + to;
      rows.fifth[x * k_nodes + y] = nodes + to + k_nodes - 1;
      for (std::size_t z = 0; z < k_nodes; ++z, ++to) {
        const float* const from = sums[number(x, y, z, 3, in_block)] + number(x, y, z, 2, in_nodes);
        for (std::size_t s = 0; s < k_sums; ++s) nodes[s * k_all + to] = from[s * k_own];
      }
    }
  }
  rows.stride = k_all;
}

}  // namespace mallow

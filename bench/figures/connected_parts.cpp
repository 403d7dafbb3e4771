#include "figures/connected_parts.h"

#include <cstdint>
#include <numeric>

#include "core/disjoint_sets.h"
#include "core/isa.h"
#include "neighbors/cell_grid.h"
#include "neighbors/neighbor_lists.h"

namespace mallow::bench {

std::vector<std::size_t> connected_parts(std::span<const Vec3> positions, float link_radius, int threads) {
  VectorColumn columns(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) columns.set(i, positions[i]);
  CellGrid grid;
  build_cell_grid(columns, 0, columns.size(), link_radius, {threads, best_instruction_level()}, grid);
  NeighborLists lists;
  build_neighbor_lists(grid, link_radius, {threads, best_instruction_level()}, lists);

  // In sorted places throughout: which points make a part is not asked, only how many.
  DisjointSets sets;
  sets.reset(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i)
    for (const std::uint32_t j : lists.of(i))
      if (j < i) sets.join(i, j);
  return sets.sizes();
}

double largest_share(std::span<const std::size_t> sizes) {
  const std::size_t all = std::accumulate(sizes.begin(), sizes.end(), std::size_t{0});
  return static_cast<double>(sizes.front()) / static_cast<double>(all);
}

}  // namespace mallow::bench

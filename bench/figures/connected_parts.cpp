#include "figures/connected_parts.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <numeric>

#include "core/isa.h"
#include "neighbors/cell_grid.h"
#include "neighbors/neighbor_lists.h"

namespace mallow::bench {
namespace {

/// Sets of points that only ever grow together; a set is known by its root.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), std::uint32_t{0});
  }
  std::uint32_t root(std::uint32_t i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];  // halves the way for the next one
    return i;
  }
  void join(std::uint32_t i, std::uint32_t j) { parents_[root(i)] = root(j); }

 private:
  std::vector<std::uint32_t> parents_;
};

}  // namespace

std::vector<std::size_t> connected_parts(std::span<const Vec3> positions, float link_radius, int threads) {
  VectorColumn columns(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) columns.set(i, positions[i]);
  CellGrid grid;
  build_cell_grid(columns, 0, columns.size(), link_radius, {threads, best_instruction_level()}, grid);
  NeighborLists lists;
  build_neighbor_lists(grid, link_radius, {threads, best_instruction_level()}, lists);

  // In sorted places throughout: which points make a part is not asked, only how many.
  DisjointSets sets(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i)
    for (const std::uint32_t j : lists.of(i))
      if (j < i) sets.join(i, j);
  std::vector<std::size_t> sizes(positions.size(), 0);
  for (std::uint32_t i = 0; i < positions.size(); ++i) ++sizes[sets.root(i)];
  std::erase(sizes, std::size_t{0});
  std::sort(sizes.begin(), sizes.end(), std::greater<>());
  return sizes;
}

double count_parts(std::span<const std::size_t> sizes) {
  return static_cast<double>(
      std::count_if(sizes.begin(), sizes.end(), [](std::size_t size) { return size >= k_crumb; }));
}

double largest_share(std::span<const std::size_t> sizes) {
  const std::size_t all = std::accumulate(sizes.begin(), sizes.end(), std::size_t{0});
  return static_cast<double>(sizes.front()) / static_cast<double>(all);
}

}  // namespace mallow::bench

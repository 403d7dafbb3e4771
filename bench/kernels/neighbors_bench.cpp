// The neighbour search of a step: sorting points into cells, then lists of all pairs within σ.
#include <algorithm>
#include <memory>
#include <numeric>
#include <random>

#include "kernels/kernel_set.h"
#include "kernels/lattice.h"
#include "neighbors/cell_grid.h"
#include "neighbors/neighbor_lists.h"

namespace mallow::bench {
namespace {

/// Irregular points with 30 neighbours on average inside of the body: 4π/3 · 1.93³.
constexpr float k_radius = 1.93f;
constexpr float k_jitter = 0.25f;
const LatticeScene k_scenes[] = {{"points_10k", {22, 22, 21}, 1.0f, k_radius},
                                 {"points_100k", {46, 46, 47}, 1.0f, k_radius},
                                 {"points_1m", {100, 100, 100}, 1.0f, k_radius}};

enum class Order { cells, shuffled };

struct Search {
  VectorColumn points;
  CellGrid grid;
  NeighborLists lists, cluster_lists;

  Search(const LatticeScene& scene, Order order, int threads, InstructionLevel level)
      : points(lattice_points(scene, k_jitter)) {
    if (order == Order::shuffled) {
      std::vector<std::uint32_t> places(points.size());
      std::iota(places.begin(), places.end(), 0u);
      std::shuffle(places.begin(), places.end(), std::mt19937(1));
      points = reordered(points, places);
    }
    grid.spacing = scene.spacing;
    build_grid(threads, level);
    build_lists(threads, level);
    build_clusters(threads, level);
  }
  void build_grid(int threads, InstructionLevel level) {
    build_cell_grid(points, 0, points.size(), k_radius, {threads, level}, grid);
  }
  void build_lists(int threads, InstructionLevel level) {
    build_neighbor_lists(grid, k_radius, {threads, level}, lists);
  }
  void build_clusters(int threads, InstructionLevel level) {
    build_cluster_lists(grid, k_radius, {threads, level}, cluster_lists);
  }
  Json about() const {
    return {{"particles", points.size()},
            {"average_neighbors", lists.average()},
            {"bytes_per_particle",
             static_cast<double>(grid.bytes() + lists.bytes()) / static_cast<double>(points.size())}};
  }
};

}  // namespace

void add_neighbors(const KernelVariants& variants, KernelSet& set) {
  for (const LatticeScene& scene : k_scenes)
    for (const Order order : {Order::cells, Order::shuffled}) {
      const std::string label = scene.name + (order == Order::cells ? "_in_cell_order" : "_shuffled");
      for (const int threads : variants.threads) {
        for (const InstructionLevel level : variants.levels) {
          set.add({"cell_grid", label, threads, name(level), "particle"}, [=] {
            const auto search = std::make_shared<Search>(scene, order, threads, level);
            return Timed{.run = [=] { search->build_grid(threads, level); },
                         .items = static_cast<double>(search->points.size()),
                         .about = search->about()};
          });
          set.add({"cluster_lists", label, threads, name(level), "pair"}, [=] {
            const auto search = std::make_shared<Search>(scene, order, threads, level);
            return Timed{.run = [=] { search->build_clusters(threads, level); },
                         .items = static_cast<double>(search->lists.total),
                         .about = search->about()};
          });
          set.add({"neighbor_lists", label, threads, name(level), "pair"}, [=] {
            const auto search = std::make_shared<Search>(scene, order, threads, level);
            return Timed{.run = [=] { search->build_lists(threads, level); },
                         .items = static_cast<double>(search->lists.total),
                         .about = search->about()};
          });
        }
      }
    }
}

}  // namespace mallow::bench

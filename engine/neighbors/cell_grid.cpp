#include "neighbors/cell_grid.h"

#include <cmath>

#include "core/bounds.h"
#include "core/parallel.h"
#include "neighbors/grid_lanes.h"

namespace mallow {
namespace {

/// Cells per point at the most; beyond that they grow, and at last the covered box shrinks.
constexpr double k_cells_per_point = 8.0;
constexpr double k_min_cells = 32768.0;
/// Edges of a cell in spacings.
constexpr double k_across = 2.0;
constexpr double k_along = 0.5;
/// Pillars that one thread handles at a time.
constexpr std::size_t k_pillar_block = 512;

/// The box of the points that are finite, or no room at 0. Others are for the caller to refuse; no box around
/// them would have an end.
Aabb finite_bounds(const VectorColumn& x, std::size_t begin, std::size_t end) {
  Aabb box{Vec3::Zero(), Vec3::Zero()};
  bool any = false;
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3 point = x.get(i);
    if (!point.allFinite()) continue;
    box = any ? Aabb{box.min.cwiseMin(point), box.max.cwiseMax(point)} : Aabb{point, point};
    any = true;
  }
  return box;
}

/// Makes the covered box one of whole cells of the lattice: those that the points lie in, within `most`.
/// Pillars stay in the strips that they are in.
void anchor(const Aabb& points, const Aabb& most, CellGrid& grid) {
  constexpr float k_most_cells = 1 << 22;  // whose numbers a float holds
  const Vec3 edges(grid.along, grid.across, grid.across);
  std::array<int, 3> first, last;
  for (int a = 0; a < 3; ++a) {
    // As lanes count.
    const auto cell = [&](float place) { return std::floor(place * (1.0f / edges[a])); };
    const float low = cell(std::max(points.min[a], most.min[a])),
                high = cell(std::min(points.max[a], most.max[a]));
    if (!(std::abs(low) < k_most_cells && std::abs(high) < k_most_cells)) return;
    first[static_cast<std::size_t>(a)] = static_cast<int>(low);
    last[static_cast<std::size_t>(a)] = static_cast<int>(std::max(low, high));
  }
  first[1] -= (first[1] % k_strip + k_strip) % k_strip;
  for (std::size_t a = 0; a < 3; ++a) {
    grid.dims[a] = last[a] - first[a] + 1;
    grid.origin[static_cast<int>(a)] = static_cast<float>(first[a]) * edges[static_cast<int>(a)];
  }
  grid.first = first;
  grid.cells_from.setZero();
  grid.rounding += 1e-6f * std::max(points.min.cwiseAbs().maxCoeff(), points.max.cwiseAbs().maxCoeff());
}

/// Chooses the cells and the covered box. Where points lie too thinly for cells of their spacing, cells are
/// made longer, then larger, up to the radius; where a few strays make the box too large even so, it shrinks
/// around the mean until its cells are affordable.
void choose_cells(const VectorColumn& x, std::size_t begin, std::size_t end, float radius,
                  const Threads& threads, CellGrid& grid) {
  Aabb own = bounds_of(x, begin, end, threads, grid.partial_bounds);
  if (!own.min.allFinite() || !own.max.allFinite()) own = finite_bounds(x, begin, end);
  const Aabb box = grid.points_beside > 0 ? box_around(own, grid.box_beside) : own;
  const auto n = static_cast<double>(end - begin + grid.points_beside);
  const double spacing = static_cast<double>(grid.spacing > 0 ? grid.spacing : 0.5f * radius);
  double across = k_across * spacing, along = k_along * spacing;
  const double budget = std::max(k_min_cells, k_cells_per_point * n);
  Eigen::Vector3d low = box.min.cast<double>(), size = box.max.cast<double>() - low;
  const auto cells = [&](int a) {
    return std::max(1.0, std::floor(size[a] / (a == 0 ? along : across)) + 1.0);
  };
  const auto too_many = [&] { return cells(0) * cells(1) * cells(2) > budget; };
  while (too_many() && along < across) along *= 2;
  while (too_many() && across < static_cast<double>(radius)) along = across *= 2;
  if (too_many()) {
    Eigen::Vector3d mean(0, 0, 0);
    for (std::size_t i = begin; i < end; ++i)
      if (x.get(i).allFinite()) mean += x.get(i).cast<double>();
    mean /= static_cast<double>(end - begin);
    while (too_many()) {
      // The size itself: of a box far from 0 low and high would not come any nearer than they are rounded.
      Eigen::Index widest = 0;
      size.maxCoeff(&widest);
      size[widest] *= 0.8;
      low[widest] = mean[widest] + 0.8 * (low[widest] - mean[widest]);
    }
  }
  grid.origin = low.cast<float>();
  grid.along = static_cast<float>(along);
  grid.across = static_cast<float>(across);
  grid.rounding = static_cast<float>(1e-6 * size.maxCoeff() + 1e-5 * static_cast<double>(radius));
  for (int a = 0; a < 3; ++a) grid.dims[static_cast<std::size_t>(a)] = static_cast<int>(cells(a));
  grid.first = {0, 0, 0};
  grid.cells_from = grid.origin;
  if (grid.anchored) anchor(own, {low.cast<float>(), (low + size).cast<float>()}, grid);
}

/// Cuts every pillar into clusters, the last of a pillar short.
void cut_clusters(const Threads& threads, CellGrid& grid) {
  const std::size_t pillars = grid.pillars(), nx = static_cast<std::size_t>(grid.dims[0]);
  const auto clusters_of = [&](std::size_t pillar) {
    return (grid.cell_start[(pillar + 1) * nx] - grid.cell_start[pillar * nx] + k_cluster - 1) / k_cluster;
  };
  grid.block_sums.resize((pillars + k_pillar_block - 1) / k_pillar_block);
  parallel_for(
      threads, pillars,
      [&](std::size_t first, std::size_t last) {
        std::size_t sum = 0;
        for (std::size_t pillar = first; pillar < last; ++pillar) sum += clusters_of(pillar);
        grid.block_sums[first / k_pillar_block] = static_cast<std::uint32_t>(sum);
      },
      k_pillar_block);
  std::uint32_t clusters = 0;
  for (std::uint32_t& sum : grid.block_sums) clusters += std::exchange(sum, clusters);
  grid.cluster_start.resize(clusters + 1);
  grid.cluster_start[clusters] = grid.cell_start[pillars * nx];
  parallel_for(
      threads, pillars,
      [&](std::size_t first, std::size_t last) {
        std::uint32_t* next = grid.cluster_start.data() + grid.block_sums[first / k_pillar_block];
        for (std::size_t pillar = first; pillar < last; ++pillar)
          for (std::size_t point = grid.cell_start[pillar * nx]; point < grid.cell_start[(pillar + 1) * nx];
               point += k_cluster)
            *next++ = static_cast<std::uint32_t>(point);
      },
      k_pillar_block);
}

}  // namespace

void build_cell_grid(const VectorColumn& positions, std::size_t begin, std::size_t end, float radius,
                     const Execution& execution, CellGrid& grid) {
  const std::size_t n = end - begin;
  choose_cells(positions, begin, end, radius, execution.threads, grid);
  const std::size_t cells = static_cast<std::size_t>(grid.dims[0]) * grid.pillars();
  grid.cell_of.resize(n);
  grid.sorted.resize(n);
  const ConstVectors x{positions.x() + begin, positions.y() + begin, positions.z() + begin};

  const SearchInput input = search_input(grid, radius);
  const GridLanes& lanes = MALLOW_SELECT(execution.level, grid_lanes);
  parallel_for(execution.threads, n, [&](std::size_t first, std::size_t last) {
    lanes.cells_of(input, x, first, last, grid.cell_of.data());
  });

  sort_by_key(grid.cell_of, cells, execution, grid.sort, grid.cell_start, grid.order);
  const Vectors sorted = raw(grid.sorted);
  const std::uint32_t* const order = grid.order.data();
  parallel_for(execution.threads, n, [&](std::size_t first, std::size_t last) {
    for (std::size_t place = first; place < last; ++place) {
      const std::size_t i = order[place];
      sorted.x[place] = x.x[i];
      sorted.y[place] = x.y[i];
      sorted.z[place] = x.z[i];
    }
  });
  cut_clusters(execution.threads, grid);
}

SearchInput search_input(const CellGrid& grid, float radius) {
  return {
      .sorted = raw(grid.sorted),
      .cell_start = grid.cell_start.data(),
      .cluster_start = grid.cluster_start.data(),
      .origin = {grid.origin.x(), grid.origin.y(), grid.origin.z()},
      .edge = {grid.along, grid.across, grid.across},
      .inverse_edge = {1.0f / grid.along, 1.0f / grid.across, 1.0f / grid.across},
      .dims = {grid.dims[0], grid.dims[1], grid.dims[2]},
      .cells_from = {grid.cells_from.x(), grid.cells_from.y(), grid.cells_from.z()},
      .first = {grid.first[0], grid.first[1], grid.first[2]},
      .squared_radius = radius * radius,
      .reach = radius + grid.rounding,
  };
}

}  // namespace mallow

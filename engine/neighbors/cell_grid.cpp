#include "neighbors/cell_grid.h"

#include <cmath>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Cells are this much larger than the radius, which covers the rounding of cell coordinates up to k_max_dim
/// cells.
constexpr float k_margin = 1.001f;
constexpr int k_max_dim = 2048;
/// Cells per point at the most; beyond that the covered box shrinks.
constexpr double k_cells_per_point = 8.0;
constexpr double k_min_cells = 32768.0;

Aabb bounds_of(const VectorColumn& x, std::size_t begin, std::size_t end, int threads,
               std::vector<Aabb>& partial) {
  const Aabb none{Vec3::Constant(HUGE_VALF), Vec3::Constant(-HUGE_VALF)};
  return parallel_reduce(
      threads, end - begin, partial, none,
      [&](std::size_t first, std::size_t last) {
        Aabb box = none;
        for (std::size_t a = 0; a < 3; ++a) {
          const float* values = x.axis(a) + begin;
          float low = HUGE_VALF, high = -HUGE_VALF;
          for (std::size_t i = first; i < last; ++i) {
            low = std::min(low, values[i]);
            high = std::max(high, values[i]);
          }
          box.min[static_cast<int>(a)] = low;
          box.max[static_cast<int>(a)] = high;
        }
        return box;
      },
      [](const Aabb& a, const Aabb& b) {
        return Aabb{a.min.cwiseMin(b.min), a.max.cwiseMax(b.max)};
      });
}

/// Chooses the covered box: the bounds, or where a few strays make those too large, a box around the mean
/// that shrinks until its cells are affordable.
void choose_cells(const VectorColumn& x, std::size_t begin, std::size_t end, float radius, int threads,
                  CellGrid& grid) {
  const Aabb box = bounds_of(x, begin, end, threads, grid.partial_bounds);
  const auto n = static_cast<double>(end - begin);
  const double cell = static_cast<double>(radius) * static_cast<double>(k_margin);
  const double budget = std::max(k_min_cells, k_cells_per_point * n);
  Eigen::Vector3d low = box.min.cast<double>(), high = box.max.cast<double>();
  const auto cells = [&](int a) { return std::max(1.0, std::floor((high[a] - low[a]) / cell) + 1.0); };
  if (cells(0) * cells(1) * cells(2) > budget || std::max({cells(0), cells(1), cells(2)}) > k_max_dim) {
    Eigen::Vector3d mean(0, 0, 0);
    for (std::size_t i = begin; i < end; ++i) mean += x.get(i).cast<double>();
    mean /= n;
    while (cells(0) * cells(1) * cells(2) > budget || std::max({cells(0), cells(1), cells(2)}) > k_max_dim) {
      Eigen::Index widest = 0;
      (high - low).maxCoeff(&widest);
      low[widest] = mean[widest] + 0.8 * (low[widest] - mean[widest]);
      high[widest] = mean[widest] + 0.8 * (high[widest] - mean[widest]);
    }
  }
  grid.origin = low.cast<float>();
  grid.inverse_cell = static_cast<float>(1.0 / cell);
  for (int a = 0; a < 3; ++a) grid.dims[static_cast<std::size_t>(a)] = static_cast<int>(cells(a));
}

/// Monotone in each coordinate and never expanding, so points within a radius are in adjacent cells also
/// where coordinates are clamped.
std::uint32_t cell_index(const CellGrid& grid, float x, float y, float z) {
  const auto coordinate = [&](float value, std::size_t a) {
    const float cell = std::floor((value - grid.origin[static_cast<int>(a)]) * grid.inverse_cell);
    return static_cast<std::uint32_t>(std::clamp(cell, 0.0f, static_cast<float>(grid.dims[a] - 1)));
  };
  const auto nx = static_cast<std::uint32_t>(grid.dims[0]), ny = static_cast<std::uint32_t>(grid.dims[1]);
  return (coordinate(z, 2) * ny + coordinate(y, 1)) * nx + coordinate(x, 0);
}

}  // namespace

void build_cell_grid(const VectorColumn& positions, std::size_t begin, std::size_t end, float radius,
                     int threads, CellGrid& grid) {
  const std::size_t n = end - begin;
  choose_cells(positions, begin, end, radius, threads, grid);
  const std::size_t cells = static_cast<std::size_t>(grid.dims[0]) * static_cast<std::size_t>(grid.dims[1]) *
                            static_cast<std::size_t>(grid.dims[2]);
  grid.cell_of.resize(n);
  grid.order.resize(n);
  grid.sorted.resize(n);
  grid.cell_start.resize(cells + 1);
  const ConstVectors x{positions.x() + begin, positions.y() + begin, positions.z() + begin};

  // Each thread counts and scatters one chunk of the points, in order: the sort is stable whatever the chunks
  // are.
  const auto chunks = static_cast<std::size_t>(threads);
  const std::size_t chunk = std::max<std::size_t>(1, (n + chunks - 1) / chunks);
  grid.counts.resize(0);
  grid.counts.resize(chunks * cells);
  parallel_for(
      threads, n,
      [&](std::size_t first, std::size_t last) {
        std::uint32_t* counts = grid.counts.data() + first / chunk * cells;
        for (std::size_t i = first; i < last; ++i) {
          const std::uint32_t cell = cell_index(grid, x.x[i], x.y[i], x.z[i]);
          grid.cell_of[i] = cell;
          ++counts[cell];
        }
      },
      chunk);
  std::uint32_t start = 0;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    grid.cell_start[cell] = start;
    for (std::size_t c = 0; c < chunks; ++c) {
      std::uint32_t& count = grid.counts[c * cells + cell];
      const std::uint32_t here = count;
      count = start;
      start += here;
    }
  }
  grid.cell_start[cells] = start;
  parallel_for(
      threads, n,
      [&](std::size_t first, std::size_t last) {
        std::uint32_t* next = grid.counts.data() + first / chunk * cells;
        for (std::size_t i = first; i < last; ++i) {
          const std::uint32_t place = next[grid.cell_of[i]]++;
          grid.order[place] = static_cast<std::uint32_t>(i);
          grid.sorted.x()[place] = x.x[i];
          grid.sorted.y()[place] = x.y[i];
          grid.sorted.z()[place] = x.z[i];
        }
      },
      chunk);
}

}  // namespace mallow

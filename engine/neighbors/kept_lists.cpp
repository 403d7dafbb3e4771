#include "neighbors/kept_lists.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Share of the radius by which a point may move less than it could: in single precision a search may miss
/// pairs that are nearer than its radius by up to 3e-7 of it, the radius itself is rounded, and the sums over
/// a list take a pair for near that is farther by as much. Motions are taken in double, where they are exact.
constexpr double k_rounding = 1e-6;

using Motion = std::array<double, 3>;

/// Gathers the present positions and returns the mean motion since the search.
Motion gather(const VectorColumn& positions, const Threads& threads, CellGrid& grid, KeptLists& kept) {
  const std::size_t n = grid.order.size();
  Motion mean = parallel_reduce(
      threads, n, kept.partial_motion, Motion{},
      [&](std::size_t begin, std::size_t end) {
        Motion sum{};
        for (std::size_t a = 0; a < 3; ++a) {
          const float *now = positions.axis(a), *before = kept.searched.axis(a);
          float* const sorted = grid.sorted.axis(a);
          for (std::size_t s = begin; s < end; ++s) {
            sorted[s] = now[grid.order[s]];
            sum[a] += static_cast<double>(sorted[s]) - static_cast<double>(before[s]);
          }
        }
        return sum;
      },
      [](const Motion& a, const Motion& b) {
        return Motion{a[0] + b[0], a[1] + b[1], a[2] + b[2]};
      });
  for (double& component : mean) component /= static_cast<double>(n);
  return mean;
}

/// Largest squared distance from where the mean motion would have taken a point.
double farthest(const Motion& mean, const Threads& threads, const CellGrid& grid, KeptLists& kept) {
  const VectorColumn &now = grid.sorted, &before = kept.searched;
  const auto motion = [&](std::size_t a, std::size_t s) {
    return static_cast<double>(now.axis(a)[s]) - static_cast<double>(before.axis(a)[s]) - mean[a];
  };
  return parallel_reduce(
      threads, now.size(), kept.partial_farthest, 0.0,
      [&](std::size_t begin, std::size_t end) {
        double largest = 0;
        for (std::size_t s = begin; s < end; ++s) {
          const double x = motion(0, s), y = motion(1, s), z = motion(2, s);
          largest = std::max(largest, x * x + y * y + z * z);
        }
        return largest;
      },
      [](double a, double b) { return std::max(a, b); });
}

}  // namespace

bool keep_lists(const VectorColumn& positions, float radius, float slack, const Threads& threads,
                CellGrid& grid, KeptLists& kept) {
  const double limit = static_cast<double>(radius) * (0.5 * static_cast<double>(slack) - k_rounding);
  if (!kept.any || !(limit > 0)) return false;
  const Motion mean = gather(positions, threads, grid, kept);
  // The largest of numbers would pass over one that is none.
  if (!std::isfinite(mean[0] + mean[1] + mean[2])) return false;
  return farthest(mean, threads, grid, kept) <= limit * limit;
}

void remember_search(const CellGrid& grid, KeptLists& kept) {
  kept.any = true;
  kept.searched.resize(grid.sorted.size());
  for (std::size_t a = 0; a < 3; ++a)
    std::copy_n(grid.sorted.axis(a), grid.sorted.size(), kept.searched.axis(a));
}

}  // namespace mallow

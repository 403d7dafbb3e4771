#include "level_set/particle_cells.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <utility>

namespace mallow {

ParticleCells::ParticleCells(std::span<const Vec3> positions, const VoxelFrame& frame, double cell_size)
    : cell_size_(cell_size) {
  const std::size_t n = positions.size();
  std::vector<Eigen::Vector3d> unsorted(n);
  Eigen::Vector3d highest(0, 0, 0);
  for (std::size_t i = 0; i < n; ++i) {
    unsorted[i] = (positions[i].cast<double>() - frame.origin) / frame.voxel_size;
    highest = highest.cwiseMax(unsorted[i]);
  }
  dims_ = cell_at(highest) + Eigen::Vector3i::Ones();

  // The index makes every entry different, so that there is one sorted order for any number of threads.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = {key(cell_at(unsorted[i])), static_cast<std::uint32_t>(i)};
  tbb::parallel_sort(order.begin(), order.end());
  positions_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    positions_[i] = unsorted[order[i].second];
    if (i == 0 || order[i].first != order[i - 1].first) {
      keys_.push_back(order[i].first);
      begins_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  begins_.push_back(static_cast<std::uint32_t>(n));
}

Eigen::Vector3i ParticleCells::cell_at(const Eigen::Vector3d& x) const {
  return (x / cell_size_).array().floor().cast<int>();
}

std::uint64_t ParticleCells::key(const Eigen::Vector3i& cell) const {
  const Eigen::Matrix<std::uint64_t, 3, 1> c = cell.cast<std::uint64_t>(), dims = dims_.cast<std::uint64_t>();
  return (c.x() * dims.y() + c.y()) * dims.z() + c.z();
}

void ParticleCells::gather(const Eigen::Vector3i& corner, int side, double radius, Offsets& out) const {
  out.clear();
  const Eigen::Vector3d low = corner.cast<double>(), high = low.array() + (side - 1);
  const Eigen::Vector3i none(0, 0, 0), last = dims_ - Eigen::Vector3i::Ones();
  const Eigen::Vector3i first_cell = cell_at(low.array() - radius).cwiseMax(none);
  const Eigen::Vector3i last_cell = cell_at(high.array() + radius).cwiseMin(last);
  if ((first_cell.array() > last_cell.array()).any()) return;
  for (int i = first_cell.x(); i <= last_cell.x(); ++i) {
    for (int j = first_cell.y(); j <= last_cell.y(); ++j) {
      // Cells of a row follow each other in key order.
      const auto begin = std::lower_bound(keys_.begin(), keys_.end(), key({i, j, first_cell.z()}));
      const auto end = std::upper_bound(begin, keys_.end(), key({i, j, last_cell.z()}));
      for (std::size_t p = begins_[static_cast<std::size_t>(begin - keys_.begin())],
                       p_end = begins_[static_cast<std::size_t>(end - keys_.begin())];
           p < p_end; ++p) {
        const Eigen::Vector3d& x = positions_[p];
        if ((x - x.cwiseMax(low).cwiseMin(high)).squaredNorm() >= radius * radius) continue;
        const Vec3 offset = (x - low).cast<float>();
        out.x.push_back(offset.x());
        out.y.push_back(offset.y());
        out.z.push_back(offset.z());
      }
    }
  }
}

}  // namespace mallow

#include <utility>

#include "core/parallel.h"
#include "shape_matching/shape_matching.h"

namespace mallow {

std::size_t ShapeMatching::bytes() const {
  std::size_t sum = reference.bytes() + regions.bytes() + weight.bytes() + region_weight.bytes() +
                    center.bytes() + rows.bytes() + sums.bytes() + undecided.bytes() + pull.bytes();
  for (const Column<float>& column : moment) sum += column.bytes();
  for (const Column<float>& column : rotation) sum += column.bytes();
  return sum;
}

void update_reference(const VectorColumn& positions, std::size_t begin, std::size_t end,
                      ShapeMatching& shape) {
  const std::size_t n = end - begin;
  Eigen::Vector3d mean(0, 0, 0);
  for (std::size_t i = begin; i < end; ++i) mean += positions.get(i).cast<double>();
  mean /= static_cast<double>(n);
  shape.reference.resize(n);
  shape.total_moment = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d x = positions.get(begin + i).cast<double>() - mean;
    shape.total_moment += x.squaredNorm();
    shape.reference.set(i, x.cast<float>());
  }
  shape.total_moment /= static_cast<double>(n);
  shape.frame = {};
  shape.built = false;
}

void build_regions(int threads, InstructionLevel level, CellGrid& grid, ShapeMatching& shape) {
  const std::size_t n = shape.reference.size();
  build_cell_grid(shape.reference, 0, n, shape.region_radius, threads, grid);
  build_neighbor_lists(grid, shape.region_radius, threads, level, shape.regions);
  // The grid may order the particles of a cell border otherwise than they lie (rounding), so go through its
  // order.
  const std::uint32_t* const order = grid.order.data();
  for (std::size_t k = 0; k < shape.regions.indices.size(); ++k) {
    std::uint32_t& index = shape.regions.indices[k];
    if (index < n) index = order[index];
  }
  Column<std::uint32_t> begin_of(n), count_of(n);
  for (std::size_t s = 0; s < n; ++s) {
    begin_of[order[s]] = shape.regions.begin[s];
    count_of[order[s]] = shape.regions.count[s];
  }
  shape.regions.begin.swap(begin_of);
  shape.regions.count.swap(count_of);

  for (Column<float>* column : {&shape.weight, &shape.region_weight}) column->resize(n);
  for (Column<float>& column : shape.moment) column.resize(n);
  for (std::size_t k = 0; k < 4; ++k) {
    shape.rotation[k].resize(n);
    // Also the padding, where a zero quaternion would have no direction.
    std::fill_n(shape.rotation[k].data(), padded(n), k == 3 ? 1.0f : 0.0f);
  }
  shape.center.resize(n);
  shape.pull.resize(n);
  shape.rows.resize(n * k_row);
  shape.sums.resize(n * k_row);
  shape.undecided.resize(n);
  for (std::size_t i = 0; i < n; ++i) shape.weight[i] = 1.0f / static_cast<float>(shape.regions.count[i]);
  parallel_for(threads, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      // Relative to the owner and in double: exact enough that no step needs to do it again.
      const Eigen::Vector3d owner = shape.reference.get(j).cast<double>();
      double weight = 0;
      Eigen::Vector3d first(0, 0, 0);
      Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
      for (const std::uint32_t i : shape.regions.of(j)) {
        const Eigen::Vector3d d = shape.reference.get(i).cast<double>() - owner;
        const double w = static_cast<double>(shape.weight[i]);
        weight += w;
        first += w * d;
        second += w * d * d.transpose();
      }
      const Eigen::Vector3d offset = first / weight;
      second -= weight * offset * offset.transpose();
      shape.region_weight[j] = static_cast<float>(weight);
      shape.center.set(j, (owner + offset).cast<float>());
      const double entries[6] = {second(0, 0), second(1, 1), second(2, 2),
                                 second(1, 2), second(0, 2), second(0, 1)};
      for (std::size_t k = 0; k < 6; ++k) shape.moment[k][j] = static_cast<float>(entries[k]);
    }
  });
  shape.built = true;
}

}  // namespace mallow

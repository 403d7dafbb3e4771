#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "shape_matching/shape_matching.h"

namespace mallow {

/// Regions that own nothing but a matrix A and a last rotation: A = B + sums with B = 1, c̄ = 0.
struct MatrixRegions {
  ShapeMatching shape;
  explicit MatrixRegions(std::size_t n, bool flows = false) {
    shape.reference.resize(n);
    shape.center.resize(n);
    shape.region_weight.resize(n);
    for (Column<float>& column : shape.moment) column.resize(n);
    for (Column<float>& column : shape.rotation) column.resize(n);
    shape.sums.resize(n * k_row);
    shape.undecided.resize(n);
    shape.flows = flows;
    reset_stretches(shape);
  }
  void set(std::size_t j, const Eigen::Matrix3d& a, const Eigen::Quaterniond& last) {
    shape.region_weight[j] = 1;
    for (std::size_t k = 0; k < 3; ++k) shape.moment[k][j] = 1;
    for (int k = 0; k < 9; ++k)
      shape.sums[j * k_row + static_cast<std::size_t>(k)] =
          static_cast<float>(a(k / 3, k % 3) - (k % 4 == 0 ? 1 : 0));
    for (std::size_t k = 0; k < 4; ++k)
      shape.rotation[k][j] = static_cast<float>(last.coeffs()[static_cast<Eigen::Index>(k)]);
  }
  void solve(InstructionLevel level, const FlowRule& rule = {}, float time_step = 0) {
    const VectorColumn x(shape.reference.size());
    MatchedBodies bodies;
    bodies.large.push_back({&shape, 0, rule, shape_input(x, 0, shape)});
    bodies.time_step = time_step;
    bodies.regions.add(shape.region_weight.size());
    solve_rotations(k_enough_iterations, {1, level}, bodies);
  }
  /// All that solve() writes of a region, bit by bit: zeros have signs. Where regions flow the mark of those
  /// that are undecided is scratch, which says what the registers of a level have left.
  std::vector<std::uint32_t> row(std::size_t j) const {
    std::vector<std::uint32_t> values;
    if (!shape.flows) values.push_back(shape.undecided[j]);
    for (std::size_t k = 0; k < k_row; ++k)
      values.push_back(std::bit_cast<std::uint32_t>(shape.sums[j * k_row + k]));
    const auto add = [&](const Column<float>& column) {
      if (!column.empty()) values.push_back(std::bit_cast<std::uint32_t>(column[j]));
    };
    for (const Column<float>& column : shape.rotation) add(column);
    for (const Column<float>& column : shape.plastic.stretch) add(column);
    add(shape.plastic.flow);
    return values;
  }
};

}  // namespace mallow

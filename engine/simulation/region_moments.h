#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "shape_matching/run_tables.h"
#include "simulation/state.h"

/// Sums over the regions of a body in double, for those who judge a motion. Differences of moments lose the
/// digits that a square of size over strain has; a double has them to spare.
namespace mallow {

/// Sums over lists of rows, each of `count` numbers that lie behind each other.
template <int count>
using Numbers = Eigen::Array<double, count, 1>;

/// What the rows of every list have in sum, by a table of runs as in the steps.
template <int count>
std::vector<Numbers<count>> sum_lists(const TableLists& lists, std::vector<Numbers<count>> table) {
  const std::size_t rows = lists.rows;
  table.reserve(rows * lists.lengths.count);
  for (std::uint32_t l = 1; l < lists.lengths.count; ++l)
    for (std::size_t i = 0; i < rows; ++i) {
      Numbers<count> sum = table[(l - 1) * rows + i];
      const std::size_t end = std::min(rows, i + lists.lengths.length[l]);
      for (std::size_t k = i + lists.lengths.length[l - 1]; k < end; ++k) sum += table[k];
      table.push_back(sum);
    }
  std::vector<Numbers<count>> sums(lists.count.size(), Numbers<count>::Zero());
  for (std::size_t list = 0; list < sums.size(); ++list)
    for (std::uint32_t k = 0; k < lists.count[list]; ++k)
      sums[list] += table[lists.entries[lists.begin[list] + k]];
  return sums;
}

/// Weighted moments of a particle, or in sum of a region: of x and of r, each from that of the first
/// particle.
struct Moments {
  static constexpr int k_count = 24;  ///< a multiple of what a vector register holds
  Numbers<k_count> all = Numbers<k_count>::Zero();

  double& weight() { return all[0]; }
  auto x() { return Eigen::Map<Eigen::Vector3d>(&all[1]); }
  auto r() { return Eigen::Map<Eigen::Vector3d>(&all[4]); }
  auto xr() { return Eigen::Map<Eigen::Matrix3d>(&all[7]); }
  double& xx() { return all[16]; }
  auto rr() { return Eigen::Map<Eigen::Matrix<double, 6, 1>>(&all[17]); }  ///< xx, yy, zz, yz, xz, xy
};

/// Positions and rest positions of a body's particles, from those of the first [m].
struct Places {
  std::vector<Eigen::Vector3d> x, rest;
};
Places places(const Simulation::State& state, const BodyState& body);

/// By region.
std::vector<Numbers<Moments::k_count>> region_moments(const ShapeMatching& shape, const Places& at);

}  // namespace mallow

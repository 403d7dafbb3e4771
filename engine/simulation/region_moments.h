#pragma once

#include <Eigen/Core>
#include <vector>

#include "shape_matching/list_sums.h"
#include "simulation/state.h"

/// Sums over the regions of a body in double, for those who judge a motion.
namespace mallow {

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

// How much space a body takes up, for those who judge a motion.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "simulation/phases.h"
#include "simulation/region_moments.h"
#include "simulation/state.h"

namespace mallow {
namespace {

using Vec = Eigen::Vector3d;
using Mat = Eigen::Matrix3d;

/// By how much a region has grown: the determinant of the affine map that takes its rest positions to where
/// its particles are, by least squares. Along what it has no extent at rest, as a sheet across, it has not
/// grown.
double growth(Moments sums) {
  constexpr double k_flat = 1e-6;  // squares of extents, as a share of the largest
  const Vec center = sums.x() / sums.weight(), rest_center = sums.r() / sums.weight();
  const Mat a = sums.xr() - sums.weight() * center * rest_center.transpose();
  const auto b = sums.rr();
  Mat rest;
  rest << b[0], b[5], b[4], b[5], b[1], b[3], b[4], b[3], b[2];
  rest -= sums.weight() * rest_center * rest_center.transpose();
  const Eigen::SelfAdjointEigenSolver<Mat> solver(rest);
  const Vec& squares = solver.eigenvalues();
  const Mat axes = solver.eigenvectors();
  Mat metric = Mat::Identity();  // F^T F along the axes that it has
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (squares[i] > k_flat * squares[2] && squares[k] > k_flat * squares[2])
        metric(i, k) = (a * axes.col(i) / squares[i]).dot(a * axes.col(k) / squares[k]);
  return std::sqrt(std::max(0.0, metric.determinant()));
}

/// Each particle takes as much more as the regions that it is in have grown in the mean.
double volume_of_regions(const Simulation::State& s, const BodyState& body, double rest_volume) {
  const ShapeMatching& shape = body.shape;
  const std::vector<Numbers<Moments::k_count>> sums = region_moments(shape, places(s, body));
  std::vector<Numbers<2>> grown(sums.size());  // by how much; one region
  for (std::size_t j = 0; j < sums.size(); ++j) grown[j] << growth({sums[j]}), 1.0;
  double volume = 0;
  for (const Numbers<2>& sum : sum_lists<2>(shape.by_particle(), std::move(grown)))
    volume += sum[1] > 0 ? rest_volume * sum[0] / sum[1] : rest_volume;
  return volume;
}

/// Where particles are less dense than at rest, as they are where they see less of each other at a surface,
/// they count as at rest: so that the volume of what lies still is that of its particles.
double volume_by_density(const Simulation::State& s, const BodyState& body, double rest_volume) {
  double volume = 0;
  for (std::size_t row = body.begin; row < body.end; ++row) {
    const double density = static_cast<double>(s.sph.density_by_row[row]),
                 mass = static_cast<double>(body.mass);
    volume += density * rest_volume > mass ? mass / density : rest_volume;
  }
  return volume;
}

}  // namespace

double Simulation::volume(BodyId id) const {
  const BodyState& body = state_->body(id);
  mallow::prepare(*state_);
  const State& s = *state_;
  const double rest_volume = static_cast<double>(body.mass) / static_cast<double>(body.rest_density);
  if (s.density_ran && s.sph.density_by_row.size() >= body.end)
    return volume_by_density(s, body, rest_volume);
  if (body.matches_shape() && body.shape.built) return volume_of_regions(s, body, rest_volume);
  return rest_volume * static_cast<double>(body.size());
}

}  // namespace mallow

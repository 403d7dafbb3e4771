#include "tradeoff/errors.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "neighbors/cell_grid.h"
#include "neighbors/neighbor_lists.h"
#include "sph/kernel_functions.h"

namespace mallow::bench {
namespace {

/// Support radius of the densities that are compared, in spacings.
constexpr double k_density_radius = 2;
/// Moments from one comparison of densities to the next.
constexpr std::size_t k_density_every = 5;

double spread(const Moment& moment) {
  const Eigen::Matrix<double, Eigen::Dynamic, 2> flat = moment.x.leftCols<2>();
  const Eigen::RowVector2d middle = flat.colwise().mean();
  return std::sqrt((flat.rowwise() - middle).rowwise().squaredNorm().mean());
}

/// Per unit of mass; the mean, as all particles have the same.
double energy(const Moment& moment, const Vec3& gravity) {
  const Eigen::Vector3d mean = moment.x.colwise().mean().transpose();
  return 0.5 * moment.v.rowwise().squaredNorm().mean() - gravity.cast<double>().dot(mean);
}

/// ρ/ρ0 of every particle, by the poly6 kernel whatever the scene's own densities are.
Eigen::VectorXd relative_density(const Moment& moment, double spacing) {
  const double radius = k_density_radius * spacing;
  const auto n = static_cast<std::size_t>(moment.x.rows());
  VectorColumn positions(n);
  for (std::size_t i = 0; i < n; ++i)
    positions.set(i, moment.x.row(static_cast<Eigen::Index>(i)).transpose().cast<float>());
  CellGrid grid;
  NeighborLists lists;
  build_cell_grid(positions, 0, n, static_cast<float>(radius), {1, best_instruction_level()}, grid);
  build_neighbor_lists(grid, static_cast<float>(radius), {1, best_instruction_level()}, lists);
  const double factor =
      static_cast<double>(kernel_factors(radius).density) / lattice_density(radius, spacing);
  Eigen::VectorXd density(moment.x.rows());
  for (std::size_t s = 0; s < n; ++s) {
    const auto i = static_cast<Eigen::Index>(grid.order[s]);
    double sum = 0;
    for (const std::uint32_t t : lists.of(s)) {
      const auto j = static_cast<Eigen::Index>(grid.order[t]);
      const double q2 = (moment.x.row(i) - moment.x.row(j)).squaredNorm() / (radius * radius);
      if (q2 < 1) sum += (1 - q2) * (1 - q2) * (1 - q2);
    }
    density[i] = factor * sum;
  }
  return density;
}

}  // namespace

Json to_json(const Errors& errors) {
  return {{"position_h", errors.position}, {"height_h", errors.height},   {"spread_h", errors.spread},
          {"density", errors.density},     {"momentum", errors.momentum}, {"energy", errors.energy}};
}

Errors compare(const Trajectory& motion, const Trajectory& reference, const Vec3& gravity,
               double particle_spacing, double unit) {
  const std::size_t count = std::min(motion.moments.size(), reference.moments.size());
  Errors sums;
  double largest_momentum = 0, largest_kinetic = 0;
  std::size_t densities = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Moment &a = motion.moments[k], &b = reference.moments[k];
    const auto square = [](double x) { return x * x; };
    sums.position += (a.x - b.x).rowwise().squaredNorm().mean();
    sums.height += square(a.x.col(2).maxCoeff() - b.x.col(2).maxCoeff());
    sums.spread += square(spread(a) - spread(b));
    sums.momentum += (a.v.colwise().mean() - b.v.colwise().mean()).squaredNorm();
    sums.energy += square(energy(a, gravity) - energy(b, gravity));
    largest_momentum = std::max(largest_momentum, b.v.colwise().mean().norm());
    largest_kinetic = std::max(largest_kinetic, 0.5 * b.v.rowwise().squaredNorm().mean());
    if (k % k_density_every != 0) continue;
    sums.density +=
        (relative_density(a, particle_spacing) - relative_density(b, particle_spacing)).squaredNorm() /
        static_cast<double>(a.x.rows());
    ++densities;
  }
  const double n = static_cast<double>(count);
  return {.position = std::sqrt(sums.position / n) / unit,
          .height = std::sqrt(sums.height / n) / unit,
          .spread = std::sqrt(sums.spread / n) / unit,
          .density = std::sqrt(sums.density / static_cast<double>(densities)),
          .momentum = std::sqrt(sums.momentum / n) / largest_momentum,
          .energy = std::sqrt(sums.energy / n) / largest_kinetic};
}

Drift free_flight_drift(const Scene& scene, double duration, int threads) {
  SolverConfig config = scene.solver;
  config.gravity.setZero();
  config.threads = threads;
  Material material = scene.materials.front().material;
  Body body = sample(scene.bodies.front(), scene.file, threads);
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : body.positions) middle += x / static_cast<float>(body.positions.size());
  for (Vec3& x : body.positions) {
    const Vec3 r = x - middle;
    // A turn and a wave within some seconds, and a drift.
    body.velocities.push_back(Vec3(0.05f, -0.02f, 0.1f).cross(r) + 0.05f * Vec3(r.x(), -r.y(), 0) +
                              Vec3(0.3f, 0, 0));
    x = r;
  }
  Simulation simulation(config);
  simulation.add_body(body, material);

  struct Sums {
    Eigen::Vector3d p{0, 0, 0}, l{0, 0, 0};
    double speeds = 0, moments = 0;
  };
  const auto sums = [&] {
    Sums s;
    const auto x = simulation.positions_by_id(), v = simulation.velocities_by_id();
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Eigen::Vector3d r = x[i].cast<double>(), u = v[i].cast<double>();
      s.p += u;
      s.l += r.cross(u);
      s.speeds += u.norm();
      s.moments += r.norm() * u.norm();
    }
    return s;
  };
  const Sums first = sums();
  while (simulation.time() < duration) simulation.step();
  const Sums last = sums();
  return {(last.p - first.p).norm() / first.speeds, (last.l - first.l).norm() / first.moments};
}

}  // namespace mallow::bench

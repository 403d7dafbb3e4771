// Section 2 of the second chapter, with walls as engine/sph/walls.h has them.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "oracle/kernels.h"
#include "oracle/oracle.h"

namespace mallow::oracle {
namespace {

Vec wendland_gradient(const Vec& d, double sigma) {
  const double r = d.norm();
  if (r > sigma) return Vec::Zero();
  return -210 / (std::numbers::pi * std::pow(sigma, 5)) * std::pow(1 - r / sigma, 3) * d;
}

/// Σ |∇W|² over an infinite cubic lattice.
double lattice_squares(double spacing, double sigma) {
  const int n = static_cast<int>(sigma / spacing) + 1;
  double sum = 0;
  for (int x = -n; x <= n; ++x)
    for (int y = -n; y <= n; ++y)
      for (int z = -n; z <= n; ++z) sum += wendland_gradient(spacing * Vec(x, y, z), sigma).squaredNorm();
  return sum;
}

/// Of S of a half space at distance d: W over the plane there.
double half_space_slope(double d, double sigma) {
  const double t = 1 - d / sigma;
  return 21 / sigma * (std::pow(t, 5) - 1.5 * std::pow(t, 6) + 4.0 / 7 * std::pow(t, 7));
}

}  // namespace

// Left out: 2 where something flows.
int Oracle::volume_iterations() const {
  const bool flows = std::ranges::any_of(groups_, [](const Group& group) {
    return group.material.plastic_yield || group.material.plastic_yield_by_temperature;
  });
  return config_.volume_iterations.value_or(flows ? 2 : 0);
}

// Reads x, ρ, v' and walls; writes v'. Returns how many iterations it took.
int Oracle::keep_volume(double dt, const std::vector<Vec>& before) {
  const double sigma = *config_.support_radius;
  const std::size_t n = particles_.size();
  const auto volume = [&](const Particle& p) { return groups_[p.group].wendland_volume; };
  const auto mass = [&](const Particle& p) { return groups_[p.group].mass; };
  const auto wall_gradient = [&](const Particle::Wall& wall) {
    return Vec(-wall.left * half_space_slope(wall.distance, sigma) * wall.normal);
  };
  std::vector<Vec> w;
  std::vector<double> lambda(n);
  for (int iteration = 0; iteration < volume_iterations(); ++iteration) {
    double compression = 0;
    w = velocities();
    touch_bodies(dt, w);
    for (std::size_t i = 0; i < n; ++i) {
      for (const Obstacle& obstacle : obstacles_)
        if (!particles_[i].pinned) touch(obstacle, particles_[i], before[i], dt, w[i]);
    }
    for (std::size_t k = 0; k < n; ++k) {
      const Particle& i = particles_[k];
      const Group& group = groups_[i.group];
      double rate = 0, others = 0;
      Vec gradient = Vec::Zero();
      for (std::size_t l = 0; l < n; ++l) {
        const Particle& j = particles_[l];
        if (!act_on_each_other(i, j)) continue;
        const Vec g = volume(j) * wendland_gradient(i.x - j.x, sigma);
        rate += (w[k] - w[l]).dot(g);
        gradient += g;
        if (!j.pinned) others += g.squaredNorm() / mass(j);
      }
      for (const Particle::Wall& wall : i.walls) {
        gradient += wall_gradient(wall);
        rate += (w[k] - wall.velocity).dot(wall_gradient(wall));
      }
      const double floor = lattice_squares(group.spacing, sigma) * volume(i) * volume(i) / mass(i) / 2;
      others /= std::max(0.5, 1 - i.wall_share);
      const double response = std::max(floor, gradient.squaredNorm() / mass(i) + others);
      const double s = std::max(0.0, i.density / group.rest_density - 1 + dt * rate);
      if (!i.pinned) compression += s / static_cast<double>(n);
      const double tau = group.material.damping_time;
      const double carried =
          2.8 * (1 + std::exp(-double{group.material.deformation_damping.value_or(0.0f)} * dt)) / 2;
      const double wide = std::min(1.0, 2.5 * group.spacing / sigma);
      const double share =
          wide * wide * wide *
          std::clamp((carried - group.most_elasticity * stiffness(group) * dt * (dt + 2 * tau)) / 2, 0.0,
                     1.0);
      lambda[k] = i.pinned ? 0 : 0.6 * share * s / (dt * response);
    }
    if (compression <= double{config_.volume_tolerance}) return iteration;
    for (std::size_t k = 0; k < n; ++k) {
      Particle& i = particles_[k];
      if (i.pinned) continue;
      Vec pushed = Vec::Zero();
      for (std::size_t l = 0; l < n; ++l) {
        const Particle& j = particles_[l];
        if (!act_on_each_other(i, j)) continue;
        pushed -=
            (lambda[k] * volume(j) + lambda[l] * volume(i)) * wendland_gradient(i.x - j.x, sigma) / mass(i);
      }
      i.v += pushed;
      for (Particle::Wall& wall : i.walls) {
        wall.push -= 2 * lambda[k] * wall_gradient(wall).dot(wall.normal) / mass(i);
        // What is behind a wall has the particle's own λ, and moves with its neighbours along it.
        i.v += pushed_along(wall, alpha_of(i), i.wall_share, pushed, dt * config_.gravity.cast<double>()) -
               2 * lambda[k] * wall_gradient(wall) / mass(i);
      }
    }
  }
  return volume_iterations();
}

}  // namespace mallow::oracle

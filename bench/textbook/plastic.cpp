#include "textbook/plastic.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "textbook/cell_grid.h"
#include "textbook/shape_matching.h"

namespace mallow::textbook {
namespace {

bool is_thin(const Region& region) {
  const Matrix p = region.stretch * region.rest_moment * region.stretch.transpose();
  return !(p.determinant() > 1e-4 * std::pow(p.trace() / 3, 3));
}

/// A layer of particles, which says nothing of strain across it.
bool is_single_layer(const Region& region) {
  return !(region.rest_moment.determinant() > 0.1 * std::pow(region.rest_moment.trace() / 3, 3));
}

/// E
Matrix elastic_strain(const Region& region) {
  const Matrix f = region.moment * region.rest_moment.inverse() * region.stretch.inverse();
  const Matrix turned = region.rotation.transpose() * f;
  return (turned + turned.transpose()) / 2;
}

/// Whether two particles that have flowed by more than `flow` are nearer than `near` in one place and farther
/// apart than `far` in the other.
bool any_part_ways(const Group& group, const std::vector<Particle>& particles, double flow,
                   Vec Particle::*here, double near, Vec Particle::*there, double far) {
  CellGrid grid(near);
  for (const std::size_t id : group.members)
    if (particles[id].region.flow > flow) grid.insert(id, particles[id].*here);
  bool found = false;
  for (const std::size_t id : group.members) {
    const Particle& i = particles[id];
    if (i.region.flow <= flow) continue;
    grid.for_each_near(i.*here,
                       [&](std::size_t j) { found |= (i.*there - particles[j].*there).norm() > far; });
  }
  return found;
}

/// Of all regions as they are turned and stretched, by unit stiffness.
double strain_energy(const Group& group, const std::vector<Particle>& particles) {
  double energy = 0;
  for (const std::size_t id : group.members) {
    const Region& region = particles[id].region;
    Vec center = Vec::Zero();
    for (const std::size_t i : region.particles) center += particles[i].weight * particles[i].position;
    center /= region.weight;
    for (const std::size_t i : region.particles) {
      const Vec arm = region.rotation * region.stretch * (particles[i].reference - region.reference_center);
      energy += 0.5 * particles[i].weight * (center + arm - particles[i].position).squaredNorm();
    }
  }
  return energy;
}

}  // namespace

void flow(const Group& group, double time_step, std::vector<Particle>& particles) {
  const double share =
      group.material.plastic_creep ? 1 - std::exp(-*group.material.plastic_creep * time_step) : 1;
  for (const std::size_t id : group.members) {
    Region& region = particles[id].region;
    if (is_thin(region) || is_single_layer(region)) continue;
    const Matrix e = elastic_strain(region);
    if (Eigen::SelfAdjointEigenSolver<Matrix>(e).eigenvalues().minCoeff() <= 0) continue;
    const Matrix strain = e / std::cbrt(e.determinant()) - Matrix::Identity();
    const double size = strain.norm(), yield = yield_of(particles[id], group);
    if (size <= yield) continue;
    const double y = std::min((1 - yield / size) * share, 0.5 / size);
    Matrix g = Matrix::Identity() + y * strain;
    g /= std::cbrt(g.determinant());
    // None that adds to elastic energy of what is crushed or comes apart.
    const bool is_whole = e.determinant() > 0.42 && e.determinant() < 2;
    const Matrix stretched = region.stretch * region.rest_moment * region.stretch.transpose();
    const auto energy = [&](const Matrix& goal) { return ((e - goal) * stretched * (e - goal)).trace(); };
    if (!is_whole && energy(g) > energy(Matrix::Identity())) continue;
    region.stretch = g * region.stretch;
    region.flow += (g - Matrix::Identity()).norm();
  }
}

bool reframe_is_due(const Group& group, const std::vector<Particle>& particles) {
  const auto far = [&](std::size_t id) { return particles[id].region.flow > 0.5; };
  return std::ranges::any_of(group.members, far) ||
         any_part_ways(group, particles, group.material.merge_flow, &Particle::position, group.spacing,
                       &Particle::reference, group.region_radius);
}

bool is_torn(const Group& group, double least_flow, const std::vector<Particle>& particles) {
  const double radius = group.region_radius;
  return any_part_ways(group, particles, least_flow, &Particle::reference, radius, &Particle::position,
                       (1 + double{group.material.tear_strain}) * radius);
}

bool has_flowed_too_far(const Group& group, const std::vector<Particle>& particles) {
  const auto far = [&](std::size_t id) { return particles[id].region.flow > 1.2; };
  return 2 * static_cast<std::size_t>(std::ranges::count_if(group.members, far)) > group.members.size();
}

bool reframe(const Group& group, bool waits, std::vector<Particle>& particles) {
  match_shape(group, 0, particles);
  std::vector<Matrix> stretches;
  std::size_t strained = 0;
  for (const std::size_t id : group.members) {
    const Region& region = particles[id].region;
    stretches.push_back(Matrix::Identity());
    if (is_thin(region)) continue;
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(elastic_strain(region));
    const Vec found = solver.eigenvalues();
    const double size = found.minCoeff() > 0 ? std::clamp(std::cbrt(found.prod()), 0.3, 1.25) : 1;
    strained += (found / size - Vec::Ones()).norm() > std::max(0.25, 2 * yield_of(particles[id], group));
    const Vec clipped = size * (found / size).cwiseMax(0.8).cwiseMin(1.25);
    const Matrix axes = region.rotation * solver.eigenvectors();
    stretches.back() = axes * clipped.cwiseInverse().asDiagonal() * axes.transpose();
  }
  if (waits && 2 * strained > stretches.size()) return false;
  const double before = strain_energy(group, particles);
  take_reference(group, particles);
  for (std::size_t k = 0; k < stretches.size(); ++k)
    particles[group.members[k]].region.stretch = stretches[k];
  const double after = strain_energy(group, particles),
               share = after > before ? std::sqrt(before / after) : 1;
  for (const std::size_t id : group.members) {
    Matrix& stretch = particles[id].region.stretch;
    stretch = share * stretch + (1 - share) * Matrix::Identity();
  }
  return true;
}

}  // namespace mallow::textbook

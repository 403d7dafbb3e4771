#include "textbook/shape_matching.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include "textbook/cell_grid.h"

namespace mallow::textbook {
namespace {

/// The rotation R that maximises tr(Rᵀ A), det +1 always. Below `silence` a singular value says nothing: a
/// rotation is fixed by two directions, and where A has fewer a trace of the last rotation decides.
Matrix polar_rotation(const Matrix& a, const Matrix& last, double silence) {
  Eigen::JacobiSVD<Matrix> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.singularValues()[1] <= silence) svd.compute(a + silence * last);
  Matrix u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

/// Writes c_j and R_j.
void match_region(const std::vector<Particle>& particles, double region_radius, Region& region) {
  region.center = Vec::Zero();
  for (const std::size_t i : region.particles) region.center += particles[i].weight * particles[i].position;
  region.center /= region.weight;
  Matrix a = Matrix::Zero();
  for (const std::size_t id : region.particles) {
    const Particle& i = particles[id];
    a += i.weight * (i.position - region.center) * (i.reference - region.reference_center).transpose();
  }
  region.rotation = polar_rotation(a, region.rotation, 1e-12 * region.weight * region_radius * region_radius);
}

}  // namespace

void take_reference(const Group& group, std::vector<Particle>& particles) {
  CellGrid grid(group.region_radius);
  for (const std::size_t id : group.members) grid.insert(id, particles[id].position);
  for (const std::size_t id : group.members) {
    Particle& i = particles[id];
    i.reference = i.position;
    i.region = {};
    grid.for_each_near(i.position, [&](std::size_t j) { i.region.particles.push_back(j); });
    i.weight = group.mass / static_cast<double>(i.region.particles.size());
  }
  for (const std::size_t id : group.members) {
    Region& region = particles[id].region;
    Vec weighted = Vec::Zero();
    for (const std::size_t i : region.particles) {
      region.weight += particles[i].weight;
      weighted += particles[i].weight * particles[i].reference;
    }
    region.reference_center = weighted / region.weight;
  }
}

void match_shape(const Group& group, std::vector<Particle>& particles) {
  for (const std::size_t j : group.members) match_region(particles, group.region_radius, particles[j].region);
  for (const std::size_t id : group.members) {
    Particle& i = particles[id];
    Vec sum = Vec::Zero();
    // j is in N_i exactly if i is in N_j.
    for (const std::size_t j : i.region.particles) {
      const Region& region = particles[j].region;
      sum += region.rotation * (i.reference - region.reference_center) + region.center;
    }
    i.goal = sum / static_cast<double>(i.region.particles.size());
  }
}

}  // namespace mallow::textbook

#include "textbook/shape_matching.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <utility>

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
  for (const std::size_t i : region.particles) region.center += particles[i].weight * particles[i].led;
  region.center /= region.weight;
  region.moment = Matrix::Zero();
  for (const std::size_t id : region.particles) {
    const Particle& i = particles[id];
    region.moment += i.weight * (i.led - region.center) * (i.reference - region.reference_center).transpose();
  }
  region.rotation = polar_rotation(region.moment * region.stretch.transpose(), region.rotation,
                                   1e-12 * region.weight * region_radius * region_radius);
}

/// Reference shape -> regions and what stays the same while it lasts.
void list_regions(const Group& group, std::vector<Particle>& particles) {
  CellGrid grid(group.region_radius);
  for (const std::size_t id : group.members) grid.insert(id, particles[id].reference);
  for (const std::size_t id : group.members) {
    Particle& i = particles[id];
    i.region.particles.clear();
    i.region.weight = 0;
    i.region.rest_moment = Matrix::Zero();
    grid.for_each_near(i.reference, [&](std::size_t j) { i.region.particles.push_back(j); });
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
    for (const std::size_t i : region.particles) {
      const Vec arm = particles[i].reference - region.reference_center;
      region.rest_moment += particles[i].weight * arm * arm.transpose();
    }
  }
}

}  // namespace

void take_reference(const Group& group, std::vector<Particle>& particles) {
  for (const std::size_t id : group.members) {
    particles[id].reference = particles[id].position;
    particles[id].region = {};
  }
  list_regions(group, particles);
}

void rest_anew(const Group& group, double mean, std::vector<Particle>& particles) {
  std::vector<Particle*> placed, left;
  for (const std::size_t id : group.members) {
    Particle& p = particles[id];
    (mean > group.update_threshold * (1 - alpha_of(p, group)) ? left : placed).push_back(&p);
  }
  if (placed.empty()) return take_reference(group, particles);
  while (!left.empty()) {
    std::vector<std::pair<Particle*, Particle*>> found;
    for (Particle* p : left) {
      const auto nearer = [&](const Particle* a, const Particle* b) {
        return (a->position - p->position).norm() < (b->position - p->position).norm();
      };
      Particle* const beside = *std::ranges::min_element(placed, nearer);
      if ((beside->position - p->position).norm() <= group.region_radius) found.emplace_back(p, beside);
    }
    if (found.empty()) break;  // what nothing reaches rests where it did
    for (const auto& [p, beside] : found) {
      p->reference =
          beside->reference + beside->region.rotation.transpose() * (p->position - beside->position);
      p->region.rotation = beside->region.rotation;
      placed.push_back(p);
      std::erase(left, p);
    }
  }
  list_regions(group, particles);
}

void match_shape(const Group& group, double lead, std::vector<Particle>& particles) {
  for (const std::size_t id : group.members)
    particles[id].led = particles[id].position + lead * particles[id].velocity;
  for (const std::size_t j : group.members) match_region(particles, group.region_radius, particles[j].region);
  for (const std::size_t id : group.members) {
    Particle& i = particles[id];
    Vec sum = Vec::Zero(), pull = Vec::Zero();
    // j is in N_i exactly if i is in N_j.
    for (const std::size_t j : i.region.particles) {
      const Region& region = particles[j].region;
      const Vec goal =
          region.rotation * region.stretch * (i.reference - region.reference_center) + region.center;
      sum += goal;
      pull += (1 - alpha_of(particles[j], group)) * particles[j].stiffness * (goal - i.led);
    }
    i.goal = sum / static_cast<double>(i.region.particles.size());
    i.pull = pull / static_cast<double>(i.region.particles.size());
  }
}

}  // namespace mallow::textbook

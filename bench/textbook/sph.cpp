#include "textbook/sph.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "textbook/cell_grid.h"

namespace mallow::textbook {
namespace {

/// The kernels of radius σ, for 0 <= r <= σ: poly6 of [TK eq. 3], the others of Müller, Charypar, Gross 2003.
/// A gradient is given as its factor of d = x_i − x_j.
struct Kernels {
  explicit Kernels(double support_radius)
      : sigma(support_radius),
        poly6_factor(315 / (64 * std::numbers::pi * std::pow(sigma, 9))),
        spiky_factor(45 / (std::numbers::pi * std::pow(sigma, 6))),
        wendland_factor(21 / (2 * std::numbers::pi * std::pow(sigma, 3))) {}

  double poly6(double r2) const {
    const double s = sigma * sigma - r2;
    return poly6_factor * s * s * s;
  }
  double poly6_gradient(double r2) const {
    const double s = sigma * sigma - r2;
    return -6 * poly6_factor * s * s;
  }
  double poly6_laplacian(double r2) const {
    const double s = sigma * sigma - r2;
    return -6 * poly6_factor * s * (3 * s - 4 * r2);
  }
  /// Coincident particles have no direction.
  double spiky_gradient(double r) const { return r > 0 ? -spiky_factor * (sigma - r) * (sigma - r) / r : 0; }
  double viscosity_laplacian(double r) const { return spiky_factor * (sigma - r); }
  /// C2, of the volume constraint. [Wendland 1995]
  double wendland(double r) const {
    return wendland_factor * std::pow(1 - r / sigma, 4) * (1 + 4 * r / sigma);
  }
  double wendland_gradient(double r) const {
    return -20 * wendland_factor / (sigma * sigma) * std::pow(1 - r / sigma, 3);
  }

  double sigma;
  double poly6_factor;
  double spiky_factor;
  double wendland_factor;
};

/// What j adds to the force density at i, but for the volume of j [N/m³].
Vec conservative_pair(const Kernels& kernels, const Particle& i, const Particle& j, double pressures,
                      double viscosity) {
  const Vec d = i.position - j.position;
  const double r = d.norm();
  Vec force = -pressures / 2 * kernels.spiky_gradient(r) * d;
  // Along the pair alone, which keeps spin.
  if (viscosity > 0 && r > 0)
    force += 5 * viscosity * kernels.viscosity_laplacian(r) * (j.velocity - i.velocity).dot(d / r) * (d / r);
  return force;
}

Vec printed_pair(const Kernels& kernels, const Particle& i, const Particle& j, double pressure,
                 double viscosity) {
  const Vec d = i.position - j.position;
  const double r2 = d.squaredNorm();
  Vec force = -pressure * kernels.poly6_gradient(r2) * d;
  if (viscosity > 0) force += viscosity * kernels.poly6_laplacian(r2) * j.velocity;
  return force;
}

}  // namespace

void find_neighbors(const SolverConfig& config, std::vector<Particle>& particles) {
  CellGrid grid(*config.support_radius);
  for (std::size_t i = 0; i < particles.size(); ++i) grid.insert(i, particles[i].position);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    particles[i].neighbors.clear();
    grid.for_each_near(particles[i].position, [&](std::size_t j) {
      if (j != i) particles[i].neighbors.push_back(j);
    });
  }
}

namespace {

/// Σ term(r) over the points of an infinite cubic lattice that are nearer than the support radius.
template <class Term>
double sum_lattice(double spacing, double support_radius, const Term& term) {
  const int reach = static_cast<int>(support_radius / spacing) + 1;
  double sum = 0;
  for (int x = -reach; x <= reach; ++x)
    for (int y = -reach; y <= reach; ++y)
      for (int z = -reach; z <= reach; ++z) {
        const double r = spacing * std::sqrt(x * x + y * y + z * z);
        if (r < support_radius) sum += term(r);
      }
  return sum;
}

/// Of one group, for the volume constraint.
struct VolumeGroup {
  double volume;  ///< of a particle, such that its lattice is as dense as poly6 says [m³]
  double least_response;
};
VolumeGroup volume_group(const Group& group, const Kernels& kernels) {
  const double sum = sum_lattice(group.spacing, kernels.sigma, [&](double r) { return kernels.wendland(r); });
  const double squares = sum_lattice(group.spacing, kernels.sigma, [&](double r) {
    return r * r * std::pow(kernels.wendland_gradient(r), 2);
  });
  const double volume = group.mass / group.rest_density * lattice_sum(group.spacing, kernels.sigma) / sum;
  return {volume, volume * volume * squares / group.mass / 2};
}

}  // namespace

void sum_densities(const SolverConfig& config, const std::vector<Group>& groups,
                   std::vector<Particle>& particles) {
  const Kernels kernels(*config.support_radius);
  std::vector<VolumeGroup> volumes;  // where volume is kept
  if (config.volume_iterations > 0)
    for (const Group& group : groups) volumes.push_back(volume_group(group, kernels));
  for (Particle& i : particles) {
    const Group& group = groups[i.group];
    const auto counts = [&](const Particle& j) {
      const double r2 = (i.position - j.position).squaredNorm();
      const Group& other = groups[j.group];
      return volumes.empty() ? other.mass / other.rest_density * kernels.poly6(r2)
                             : volumes[j.group].volume * kernels.wendland(std::sqrt(r2));
    };
    double sum = counts(i);
    for (const std::size_t id : i.neighbors) sum += counts(particles[id]);
    i.density = group.rest_density * sum;
    i.pressure = group.pressure_coefficient * (i.density - group.rest_density);
    if (i.pressure < 0) i.pressure *= group.cohesion;
  }
}

void sum_accelerations(const SolverConfig& config, const std::vector<Group>& groups,
                       std::vector<Particle>& particles) {
  const Kernels kernels(*config.support_radius);
  const bool printed = config.formulation == Formulation::printed;
  for (Particle& i : particles) {
    const Group& group = groups[i.group];
    Vec same_group = Vec::Zero(), blended = Vec::Zero(), other_groups = Vec::Zero();
    // The print does not leave out j = i, whose viscosity is not zero there.
    if (printed)
      same_group = group.mass / i.density * printed_pair(kernels, i, i, i.pressure, group.viscosity);
    blended = alpha_of(i, group) * same_group;
    for (const std::size_t id : i.neighbors) {
      const Particle& j = particles[id];
      const Group& group_j = groups[j.group];
      const double viscosity = (group.viscosity + group_j.viscosity) / 2;
      // In the viscous term densities are at least those at rest.
      const double thick =
          std::min(1.0, i.density / group.rest_density) * std::min(1.0, j.density / group_j.rest_density);
      const bool touching = j.group != i.group;
      const double p_i = i.pressure * (touching ? group.contact_share : 1);
      const double p_j = j.pressure * (touching ? group_j.contact_share : 1);
      const Vec force = printed ? printed_pair(kernels, i, j, p_j, viscosity)
                                : conservative_pair(kernels, i, j, p_i + p_j, thick * viscosity);
      const Vec added = group_j.mass / j.density * force;
      (touching ? other_groups : same_group) += added;
      if (!touching) blended += (alpha_of(i, group) + alpha_of(j, group)) / 2 * added;
    }
    i.sph_acceleration = same_group / i.density;
    i.blended_acceleration = blended / i.density;
    i.external_acceleration += other_groups / i.density;
  }
}

namespace {

Vec wendland_slope(const Kernels& kernels, const Particle& i, const Particle& j) {
  const Vec d = i.position - j.position;
  return kernels.wendland_gradient(d.norm()) * d;
}

std::vector<VolumeGroup> volume_groups(const std::vector<Group>& groups, const Kernels& kernels) {
  std::vector<VolumeGroup> of_groups;
  for (const Group& group : groups) of_groups.push_back(volume_group(group, kernels));
  return of_groups;
}

}  // namespace

Compression find_compression(const SolverConfig& config, const std::vector<Group>& groups, double time_step,
                             const std::vector<double>& share, const std::vector<Vec>& contacted,
                             const std::vector<Particle>& particles) {
  const Kernels kernels(*config.support_radius);
  const std::vector<VolumeGroup> of_groups = volume_groups(groups, kernels);
  Compression found;
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const Particle& i = particles[k];
    const Group& group = groups[i.group];
    double rate = 0, others = 0;
    Vec sum = Vec::Zero();
    for (const std::size_t id : i.neighbors) {
      const Particle& j = particles[id];
      const Vec g = of_groups[j.group].volume * wendland_slope(kernels, i, j);
      rate += (contacted[k] - contacted[id]).dot(g);
      sum += g;
      if (!j.pinned) others += g.squaredNorm() / groups[j.group].mass;
    }
    const double response =
        std::max(of_groups[i.group].least_response, sum.squaredNorm() / group.mass + others);
    const double s = i.pinned ? 0 : std::max(0.0, i.density / group.rest_density - 1 + time_step * rate);
    found.mean += s / static_cast<double>(particles.size());
    found.multipliers.push_back(0.6 * share[i.group] * s / (time_step * response));
  }
  return found;
}

void correct_volume(const SolverConfig& config, const std::vector<Group>& groups,
                    const std::vector<double>& multipliers, std::vector<Particle>& particles) {
  const Kernels kernels(*config.support_radius);
  const std::vector<VolumeGroup> of_groups = volume_groups(groups, kernels);
  for (std::size_t k = 0; k < particles.size(); ++k) {
    Particle& i = particles[k];
    if (i.pinned) continue;
    for (const std::size_t id : i.neighbors) {
      const Particle& j = particles[id];
      i.velocity -=
          (multipliers[k] * of_groups[j.group].volume + multipliers[id] * of_groups[i.group].volume) *
          wendland_slope(kernels, i, j) / groups[i.group].mass;
    }
  }
}

double lattice_sum(double spacing, double support_radius) {
  const Kernels kernels(support_radius);
  return sum_lattice(spacing, support_radius, [&](double r) { return kernels.poly6(r * r); });
}

}  // namespace mallow::textbook

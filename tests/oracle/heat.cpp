// Section 7 of the second chapter, with surfaces as engine/heat/heat_lattice.h has them.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "oracle/kernels.h"
#include "oracle/oracle.h"
#include "oracle/signed_distance.h"

namespace mallow::oracle {
namespace {

/// Of pairs of Cleary & Monaghan: the gradient of poly6 over r, up to a factor.
double pair_weight(double r, double sigma) {
  return r < sigma ? std::pow(1 - r * r / (sigma * sigma), 2) : 0;
}

double exposed_share(double density) {
  return std::max(0.0, 0.9 - density);
}

/// A lattice that fills the half space z <= 0, whose layers are z = 0, −1, ...; lengths in spacings.
struct Face {
  double sigma;
  double (*density_kernel)(double, double);
  int reach = static_cast<int>(sigma) + 1;

  /// Sums f(d) over the points d from one of layer l, itself included; all of them: l beyond the reach.
  template <class F>
  double sum(int l, const F& f) const {
    double sum = 0;
    for (int x = -reach; x <= reach; ++x)
      for (int y = -reach; y <= reach; ++y)
        for (int z = -reach; z <= std::min(l, reach); ++z) sum += f(Vec(x, y, z));
    return sum;
  }
  double density(int l) const {
    const auto kernel = [&](const Vec& d) { return density_kernel(d.norm(), sigma); };
    return sum(l, kernel) / sum(reach, kernel);
  }
  double along(int l) const {
    return sum(l, [&](const Vec& d) { return pair_weight(d.norm(), sigma) * d.x() * d.x(); });
  }
};

}  // namespace

// What makes sums over pairs of a lattice the Laplacian, within and along a face.
Oracle::HeatLattice Oracle::heat_lattice(const Group& group) const {
  const Face face{*config_.support_radius / group.spacing, volume_iterations() > 0 ? wendland : poly6};
  HeatLattice lattice;
  lattice.factor = 2 / face.along(face.reach);
  lattice.open = (face.along(face.reach) / face.along(0) - 1) / (1 / face.density(0) - 1);
  std::vector<double> counts;
  for (int l = 0; l < 4 * face.reach + 4; ++l) counts.push_back(lattice.counts(face.density(l)));
  // Heat that crosses between two layers where T falls by 1 a layer, against that within.
  for (int l = 0; l < 2 * face.reach + 2; ++l) {
    lattice.exposure += exposed_share(face.density(l));
    double through = 0;
    for (int from = 0; from <= l; ++from)
      for (int x = -face.reach; x <= face.reach; ++x)
        for (int y = -face.reach; y <= face.reach; ++y)
          for (int to = l + 1; to <= from + face.reach; ++to)
            through += pair_weight(Vec(x, y, to - from).norm(), face.sigma) * (to - from) *
                       (counts[static_cast<std::size_t>(from)] + counts[static_cast<std::size_t>(to)]) / 2;
    lattice.resistance += 1 / (lattice.factor * through) - 1;
  }
  return lattice;
}

double Oracle::HeatLattice::counts(double density) const {
  return 1 + open * std::clamp(1 / density - 1, 0.0, 3.0);
}

double Oracle::heated(const Material& material, double temperature, double gained) {
  const double c = material.specific_heat, latent = material.latent_heat;
  if (latent == 0) return temperature + gained / c;
  const double solid = *material.solidus, range = double{*material.liquidus} - solid;
  const double above = temperature - solid;
  const double enthalpy = c * above + latent * std::clamp(above / range, 0.0, 1.0) + gained;
  if (enthalpy <= 0) return solid + enthalpy / c;
  if (enthalpy >= c * range + latent) return solid + (enthalpy - latent) / c;
  return solid + enthalpy / (c + latent / range);
}

/// What a particle exchanges with colliders that it touches, and else with the air.
Oracle::Bath Oracle::bath_of(const Particle& p, const HeatLattice& lattice) const {
  const Group& group = groups_[p.group];
  const Material& material = group.material;
  const double h = group.spacing, kappa = material.conductivity;
  const double inward = config_.contact_offset.value_or(h / 2) - h / 2;
  Bath bath;
  for (const Obstacle& obstacle : obstacles_) {
    const Collider& collider = obstacle.collider;
    if (!collider.temperature || kappa == 0) continue;
    for (const Primitive& part : parts_of(collider)) {
      const double d = distance(part, p.x - obstacle.moved).value - inward;
      if (d > h) continue;
      const double film = collider.heat_transfer ? 1 / double{*collider.heat_transfer} : 0;
      const double g = h * h / (std::max(d - lattice.resistance * h, h / 8) / kappa + film);
      bath.conductance += g;
      bath.flow += g * alpha_at(*collider.temperature, time_);
    }
  }
  if (bath.conductance > 0) return bath;
  bath.conductance =
      material.heat_transfer * h * h * exposed_share(p.density / group.rest_density) / lattice.exposure;
  bath.flow = bath.conductance * alpha_at(config_.air_temperature, time_);
  return bath;
}

// Explicit, in as many parts as keep each within its surroundings.
void Oracle::conduct(double dt) {
  if (!carries_heat()) return;
  if (lattices_.empty())
    for (const Group& group : groups_) lattices_.push_back(heat_lattice(group));
  const auto counts = [&](const Particle& p) {
    return lattices_[p.group].counts(p.density / groups_[p.group].rest_density);
  };
  const auto conductance = [&](const Particle& i, const Particle& j) {
    const Group &a = groups_[i.group], &b = groups_[j.group];
    const double r = (i.x - j.x).norm(), kappa = a.material.conductivity, other = b.material.conductivity;
    if (i.group != j.group && r > 1.25 * (a.spacing + b.spacing) / 2) return 0.0;
    if (!a.material.temperature || !b.material.temperature || kappa * other == 0) return 0.0;
    const double factor = (lattices_[i.group].factor * a.spacing + lattices_[j.group].factor * b.spacing) / 2;
    return 2 * kappa * other / (kappa + other) * factor * (counts(i) + counts(j)) / 2 *
           pair_weight(r, *config_.support_radius);
  };
  const std::size_t n = particles_.size();
  std::vector<Bath> baths(n);
  double fastest = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const Particle& i = particles_[k];
    const Group& group = groups_[i.group];
    if (!group.material.temperature) continue;
    baths[k] = bath_of(i, lattices_[i.group]);
    double all = baths[k].conductance;
    for (const Particle& j : particles_)
      if (&j != &i) all += conductance(i, j);
    fastest = std::max(fastest, all / (group.mass * group.material.specific_heat));
  }
  const double parts = std::max(1.0, std::ceil(dt * fastest / 0.8));
  if (parts > 200) throw std::runtime_error("heat would take more than 200 parts of a step");
  for (double part = 0; part < parts; ++part) {
    std::vector<double> after(n);
    for (std::size_t k = 0; k < n; ++k) {
      const Particle& i = particles_[k];
      double power = baths[k].flow - baths[k].conductance * i.temperature;
      for (const Particle& j : particles_) power += conductance(i, j) * (j.temperature - i.temperature);
      const Group& group = groups_[i.group];
      after[k] = group.material.temperature
                     ? heated(group.material, i.temperature, dt / parts * power / group.mass)
                     : i.temperature;
    }
    for (std::size_t k = 0; k < n; ++k) particles_[k].temperature = after[k];
  }
}

bool Oracle::carries_heat() const {
  return std::any_of(groups_.begin(), groups_.end(),
                     [](const Group& group) { return group.material.temperature.has_value(); });
}

// What follows temperatures, but for viscosity.
void Oracle::follow_temperatures() {
  for (Particle& p : particles_) {
    const Material& material = groups_[p.group].material;
    if (!material.temperature) continue;
    if (material.alpha_by_temperature) p.own_alpha = alpha_at(*material.alpha_by_temperature, p.temperature);
    if (material.plastic_yield_by_temperature)
      p.own_yield = alpha_at(*material.plastic_yield_by_temperature, p.temperature);
  }
}

double Oracle::viscosity_of(const Particle& p) const {
  const Group& group = groups_[p.group];
  if (!group.material.temperature || !group.material.viscosity_by_temperature) return group.viscosity;
  return alpha_at(*group.material.viscosity_by_temperature, p.temperature);
}

}  // namespace mallow::oracle

// Energies of model 2, section 4, in double and one thread: for those who judge a motion, not for its steps.
#include <span>
#include <vector>

#include "core/polar_rotation.h"
#include "shape_matching/run_tables.h"
#include "simulation/phases.h"
#include "simulation/state.h"

namespace mallow {
namespace {

using Vec = Eigen::Vector3d;

/// Σ_j ½ Σ_i w_i |x_i − goal_ij|² of a body of unit masses [m²], and g − x of its particles [m].
double match(const Simulation::State& state, const BodyState& body, std::vector<Vec>& pull) {
  const ShapeMatching& shape = body.shape;
  const auto x = [&](std::uint32_t i) {
    return Vec(state.store.position.get(body.begin + i).cast<double>());
  };
  const auto rest = [&](std::uint32_t i) { return Vec(shape.reference.get(i).cast<double>()); };
  std::vector<double> regions(body.size(), 0);
  pull.assign(body.size(), Vec::Zero());
  double sum = 0;
  for (std::size_t j = 0; j < shape.region_weight.size(); ++j) {
    const std::vector<std::uint32_t> members = decode(shape.regions, j);
    double weight = 0;
    Vec center = Vec::Zero(), rest_center = Vec::Zero();
    for (const std::uint32_t i : members) {
      const double w = static_cast<double>(shape.weight[i]);
      weight += w;
      center += w * x(i);
      rest_center += w * rest(i);
    }
    center /= weight;
    rest_center /= weight;
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    double scale = 0;
    for (const std::uint32_t i : members) {
      const double w = static_cast<double>(shape.weight[i]);
      a += w * (x(i) - center) * (rest(i) - rest_center).transpose();
      scale += w * (rest(i) - rest_center).squaredNorm();
    }
    const auto q = [&](std::size_t k) { return static_cast<double>(shape.rotation[k][j]); };
    const Eigen::Quaterniond last(q(3), q(0), q(1), q(2));
    Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity();
    if (shape.flows) {
      stretch = carried_stretch(shape.plastic, j).stretch.cast<double>();
      scale = stretched_moment(shape, j).trace();
    }
    const Eigen::Matrix3d rotation =
        polar_rotation(a * stretch.transpose(), last, scale).toRotationMatrix() * stretch;
    const std::size_t owner = body.begin + shape.owner(j);
    const double share =
        body.is_painted() ? static_cast<double>((1 - state.store.alpha[owner]) * state.store.stiffness[owner])
                          : 1.0;
    for (const std::uint32_t i : members) {
      const Vec away = rotation * (rest(i) - rest_center) + center - x(i);
      sum += 0.5 * share * static_cast<double>(shape.weight[i]) * away.squaredNorm();
      pull[i] += share * away;
      regions[i] += 1;
    }
  }
  for (std::size_t i = 0; i < pull.size(); ++i) pull[i] /= regions[i];
  return sum;
}

/// Adds a body to a sum, whose `conserved` still lacks the other three.
void add_energy(const Simulation::State& s, const BodyState& body, std::vector<Vec>& pull, Energy& energy) {
  const Vec gravity = s.config.gravity.cast<double>();
  const double mass = static_cast<double>(body.mass);
  const double stiffness = static_cast<double>(s.stiffness(body));
  const bool is_elastic = body.matches_shape() && body.shape.built;
  if (is_elastic) energy.elastic += stiffness * mass * match(s, body, pull);
  for (std::size_t row = body.begin; row < body.end; ++row) {
    if (!s.store.pin.empty() && s.store.pin[row] != 0) continue;
    const Vec x = s.store.position.get(row).cast<double>() + s.origin.cast<double>();
    const Vec v = s.store.velocity.get(row).cast<double>();
    const Vec a = is_elastic ? Vec(gravity + stiffness * pull[row - body.begin]) : gravity;
    energy.kinetic += 0.5 * mass * v.squaredNorm();
    energy.gravity -= mass * gravity.dot(x);
    energy.conserved += 0.5 * mass * s.last_time_step * v.dot(a);
  }
}

Energy energy_of(const Simulation::State& s, std::span<const BodyState> bodies) {
  Energy energy;
  std::vector<Vec> pull;
  for (const BodyState& body : bodies) add_energy(s, body, pull, energy);
  energy.conserved += energy.kinetic + energy.gravity + energy.elastic;
  return energy;
}

}  // namespace

Energy Simulation::energy() const {
  mallow::prepare(*state_);
  return energy_of(*state_, state_->bodies);
}

Energy Simulation::energy(BodyId id) const {
  const BodyState& body = state_->body(id);
  mallow::prepare(*state_);
  return energy_of(*state_, {&body, 1});
}

}  // namespace mallow

// Energies of model 2, section 4, in double and one thread: for those who judge a motion, not for its steps.
#include <Eigen/Cholesky>
#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "core/polar_rotation.h"
#include "simulation/phases.h"
#include "simulation/region_moments.h"
#include "simulation/state.h"

namespace mallow {
namespace {

using Vec = Eigen::Vector3d;

constexpr int k_newton = 5;             ///< iterations; from a step's rotation two or three do
constexpr double k_least_pivot = 1e-2;  ///< as a share of A at rest: far from where two rotations are as good
constexpr double k_exact_turn = 1e-7;   ///< [rad]; the iteration after it is exact, as its square counts

/// polar_rotation() by Newton's method from the last rotation; where that does not get there, the slow way.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& a, const Eigen::Quaterniond& last, double scale) {
  Eigen::Quaterniond q = last.normalized();
  for (int iteration = 0; iteration < k_newton; ++iteration) {
    const Eigen::Matrix3d b = q.toRotationMatrix().transpose() * a;
    const Eigen::Matrix3d curvature = b.trace() * Eigen::Matrix3d::Identity() - 0.5 * (b + b.transpose());
    const Eigen::LLT<Eigen::Matrix3d> factors(curvature);  // positive definite at no other than the best one
    const double pivot = factors.matrixLLT().diagonal().cwiseAbs().minCoeff();
    if (factors.info() != Eigen::Success || !(pivot * pivot > k_least_pivot * scale)) break;
    const Vec turn = factors.solve(Vec(b(2, 1) - b(1, 2), b(0, 2) - b(2, 0), b(1, 0) - b(0, 1)));
    q = (q * Eigen::Quaterniond(1, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z())).normalized();
    if (turn.squaredNorm() < k_exact_turn * k_exact_turn) return q.toRotationMatrix();
  }
  return polar_rotation(a, last, scale).toRotationMatrix();
}

/// Σ_j ½ Σ_i w_i |x_i − goal_ij|² of a body of unit masses [m²], and g − x of its particles [m].
double match(const Simulation::State& state, const BodyState& body, std::vector<Vec>& pull) {
  const ShapeMatching& shape = body.shape;
  const Places at = places(state, body);
  const std::size_t regions = shape.region_weight.size();
  std::vector<Numbers<Moments::k_count>> sums = region_moments(shape, at);
  std::vector<Numbers<14>> goals(regions);  // x -> turn x + shift, by share; share; one region
  double sum = 0;
  for (std::size_t j = 0; j < regions; ++j) {
    Moments m{sums[j]};
    const Vec center = m.x() / m.weight(), rest_center = m.r() / m.weight();
    const Eigen::Matrix3d a = m.xr() - m.weight() * center * rest_center.transpose();
    const auto b = m.rr();
    Eigen::Matrix3d rest_moment;
    rest_moment << b[0], b[5], b[4], b[5], b[1], b[3], b[4], b[3], b[2];
    rest_moment -= m.weight() * rest_center * rest_center.transpose();
    const auto q = [&](std::size_t k) { return static_cast<double>(shape.rotation[k][j]); };
    const Eigen::Quaterniond last(q(3), q(0), q(1), q(2));
    Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity();
    double scale = rest_moment.trace();
    if (shape.flows) {
      stretch = carried_stretch(shape.plastic, j).stretch.cast<double>();
      scale = stretched_moment(shape, j).trace();
    }
    const Eigen::Matrix3d turn = nearest_rotation(a * stretch.transpose(), last, scale) * stretch;
    const std::size_t owner = body.begin + shape.owner(j);
    const double share =
        body.is_painted() ? static_cast<double>((1 - state.store.alpha[owner]) * state.store.stiffness[owner])
                          : 1.0;
    // Σ w |turn (r − r_c) − (x − x_c)|², multiplied out.
    const double away = m.xx() - m.weight() * center.squaredNorm() +
                        (turn * rest_moment * turn.transpose()).trace() - 2 * turn.cwiseProduct(a).sum();
    sum += 0.5 * share * std::max(0.0, away);
    goals[j].segment<9>(0) = share * turn.reshaped().array();
    goals[j].segment<3>(9) = share * (center - turn * rest_center).array();
    goals[j][12] = share;
    goals[j][13] = 1;
  }
  const std::vector<Numbers<14>> of_particles = sum_lists<14>(shape.by_particle(), std::move(goals));
  pull.resize(body.size());
  for (std::size_t i = 0; i < pull.size(); ++i) {
    const Numbers<14>& goal = of_particles[i];
    const Eigen::Map<const Eigen::Matrix3d> turn(goal.data());
    const Eigen::Map<const Vec> shift(goal.data() + 9);
    pull[i] = (turn * at.rest[i] + shift - goal[12] * at.x[i]) / goal[13];
  }
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

Energy energy_of(const Simulation::State& s, const auto& bodies) {
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
  return energy_of(*state_, std::span(&body, 1));
}

}  // namespace mallow

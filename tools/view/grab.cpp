#include "view/grab.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "view/verbs.h"

namespace mallow::view {
namespace {

/// Of the longest step, by the time in which the spring swings by 1 rad: a damped spring is stable below 1.
constexpr float k_stiffness = 0.35f;
/// Spacings in a step by step, at most, that the pull adds to velocities.
constexpr float k_most = 0.5f;

}  // namespace

Grab::Grab(Simulation& simulation, const Vec3& at, float radius, float strength)
    : hold_(std::make_shared<Hold>()) {
  const std::optional<NearestParticle> nearest = simulation.nearest_particle(at);
  if (!nearest) throw ConfigError("grab", "there is no particle to take hold of");
  hold_->ids = simulation.particles_in(at, radius);
  if (hold_->ids.empty()) hold_->ids = {nearest->particle};
  const VectorView positions = simulation.positions();
  for (const ParticleId id : hold_->ids) {
    const float share = (positions[simulation.row(id)] - at).norm() / radius;
    const float inside = std::max(1 - share * share, 0.05f);
    hold_->weights.push_back(inside * inside);
  }
  simulation.prepare();
  const float step = simulation.config().time_step_factor * simulation.config().time_step.value_or(1);
  hold_->target = middle(simulation);
  hold_->stiffness = strength * k_stiffness * k_stiffness / (step * step);
  hold_->most = strength * k_most * simulation.spacing(nearest->body) / (step * step);
  act_on(simulation);
}

Vec3 Grab::middle(const Simulation& simulation) const {
  const VectorView positions = simulation.positions();
  Vec3 sum = Vec3::Zero();
  float weights = 0;
  for (std::size_t k = 0; k < hold_->ids.size(); ++k) {
    const auto row = row_of(simulation, hold_->ids[k]);
    if (!row) continue;
    sum += hold_->weights[k] * positions[*row];
    weights += hold_->weights[k];
  }
  return weights > 0 ? Vec3(sum / weights) : hold_->target;
}

void Grab::act_on(Simulation& simulation) const {
  simulation.set_force([hold = hold_, &simulation](const ForceInput& input, VectorSpan accelerations) {
    pull(*hold, simulation, input, accelerations);
  });
}

void Grab::pull(const Hold& hold, const Simulation& simulation, const ForceInput& input,
                VectorSpan accelerations) {
  std::vector<std::size_t> rows;
  std::vector<float> weights;
  Vec3 middle = Vec3::Zero(), velocity = Vec3::Zero();
  float sum = 0;
  for (std::size_t k = 0; k < hold.ids.size(); ++k) {
    const auto row = row_of(simulation, hold.ids[k]);
    if (!row) continue;
    rows.push_back(*row);
    weights.push_back(hold.weights[k]);
    middle += hold.weights[k] * input.positions[*row];
    velocity += hold.weights[k] * input.velocities[*row];
    sum += hold.weights[k];
  }
  if (rows.empty()) return;
  const float damping = 2 * std::sqrt(hold.stiffness);
  Vec3 pull = hold.stiffness * (hold.target - middle / sum) - damping * velocity / sum;
  if (const float size = pull.norm(); size > hold.most) pull *= hold.most / size;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    accelerations.x()[rows[k]] += weights[k] * pull.x();
    accelerations.y()[rows[k]] += weights[k] * pull.y();
    accelerations.z()[rows[k]] += weights[k] * pull.z();
  }
}

}  // namespace mallow::view

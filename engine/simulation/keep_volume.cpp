// Between v' and contact: what keeps densities from rising above those at rest.
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "simulation/phases.h"
#include "simulation/settings.h"
#include "simulation/state.h"

namespace mallow {
namespace {

/// What contact would make of v', which stays: what is pressed against a floor is pressed together only where
/// the floor is known of. Without, bodies at rest stayed a quarter too dense.
const VectorColumn& find_contacted(Simulation::State& state, float time_step, bool again) {
  const VectorColumn& predicted = state.store.next_velocity;
  const bool collides = !state.placed_colliders.empty();
  if (!collides && !state.bodies_touch()) return predicted;
  VectorColumn& contacted = state.volume.contacted;
  contacted.resize_unset(predicted.size());
  parallel_for(state.execution.threads, predicted.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = 0; a < 3; ++a)
      std::copy(predicted.axis(a) + begin, predicted.axis(a) + end, contacted.axis(a) + begin);
  });
  if (state.bodies_touch()) touch_bodies(state, time_step, {.again = again}, contacted);
  if (collides) preview_contact(state.execution, state.store, state.moving, contacted);
  return contacted;
}

/// Share of what a particle alone would ask for that an iteration may take at most. In a lattice of σ 2.1
/// spacings the largest eigenvalue of what all together do is 2.8 D; from 0.66 on a pool never came to rest.
constexpr double k_most_relaxation = 0.6;
/// A correction is a spring beside that of shape matching, as pressure is (motion/time_step.cpp): as stiff as
/// one with k = σ²/(α Δt²) where nothing else acts. With a = (1 − α) Δt²/(Δt0 Δt_SM) and all of it whatever a
/// is, an elastic cube of σ 2.6 spacings dropped on a floor gained 13 times its energy at a 1.5 and 85 times
/// at 2.5; with (2.8 − a)/2 of it none at any a up to 2.5; dropped flat and unstirred, every layer hitting at
/// once, and given all back by the floor, 5% at a 1. Up to a 0.8 it is all. Damping takes its part of what a
/// step carries, as it does there.
constexpr double k_together = 2.8;
/// Support radius in spacings up to which all that was measured. What an iteration overshoots grows with the
/// number of neighbours: the operator's largest eigenvalue goes as 1/σ², D as h³/σ⁵. With all of it at
/// 4 spacings and more a body at rest threw itself about.
constexpr double k_wide = 2.5;

}  // namespace

float volume_relaxation(const Simulation::State& state, const BodyState& body, float time_step) {
  const Material& material = body.material->settings;
  const double step = static_cast<double>(time_step);
  const double rate = static_cast<double>(material.deformation_damping.value_or(0.0f));
  const double pull = static_cast<double>(state.most_stiffness(body)) * step *
                      (step + 2 * static_cast<double>(material.damping_time));
  const double most = k_together * (1 + 0.5 * std::expm1(-rate * step));
  const double wide =
      k_wide * static_cast<double>(body.spacing) / static_cast<double>(state.support_radius());
  return static_cast<float>(k_most_relaxation * std::clamp(0.5 * (most - pull), 0.0, 1.0) *
                            std::min(1.0, wide * wide * wide));
}

void correct_volume(Simulation::State& state, float time_step, StepReport& report) {
  const VolumeStep step{.position = state.store.position,
                        .pin = state.store.pin.empty() ? nullptr : state.store.pin.data(),
                        .colliders = state.placed_colliders,
                        .time_step = time_step,
                        .gravity = state.config.gravity,
                        .alpha = state.is_painted() ? state.store.alpha.data() : nullptr};
  for (const BodyState* body : state.awake)
    state.volume.groups[body->sph_group].relaxation = volume_relaxation(state, *body, time_step);
  const double tolerance = static_cast<double>(state.config.volume_tolerance);
  const int most = state.volume_iterations();
  begin_volume(step, state.sph, state.execution, state.volume);
  for (int& taken = report.volume_iterations;; ++taken) {
    const VectorColumn& contacted = find_contacted(state, time_step, taken > 0);
    const Compression found =
        find_compression(step, contacted, taken == 0, state.sph, state.execution, state.volume);
    report.mean_compression = found.mean;
    report.largest_compression = found.largest;
    if (found.largest == 0 || (tolerance > 0 && found.mean <= tolerance)) break;
    if (taken == most) break;
    correct_velocities(step, state.sph, state.execution, state.volume, state.store.next_velocity);
    if (tolerance == 0 && taken + 1 == most) {
      ++taken;
      break;
    }
  }
  add_wall_loads(state, state.volume.wall_loads, time_step);
  remember_predicted(state.execution, state.store, state.moving);
}

}  // namespace mallow

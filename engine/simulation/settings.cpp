#include "simulation/settings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "colliders/pose.h"
#include "config/validation.h"
#include "simulation/state.h"

namespace mallow {
namespace {

/// Shares of Δt0 by which times may miss a multiple of the period: far above what their sums are off by.
constexpr double k_tolerance = 1e-6;

/// What moves fastest at the start [m/s].
float fastest_speed(const Simulation::State& state) {
  float speed = largest_norm(state.store.velocity);
  for (const Collider& collider : state.colliders)
    speed = std::max(speed, static_cast<float>(greatest_speed(collider)));
  for (const PinState& pin : state.pins) speed = std::max(speed, pin.velocity.norm());
  return speed;
}

/// Settles Δt0 of `config`.
TimeStepSource resolve_time_step(const SceneScale& scale, SolverConfig& config) {
  if (config.time_step) return TimeStepSource::given;
  config.time_step = default_time_step(scale);
  if (!config.time_step)
    throw ConfigError("solver.time_step",
                      "is missing: without gravity, and where nothing moves, nothing says how long a second "
                      "is; give it, a number of seconds above 0");
  if (!(std::isfinite(*config.time_step) && *config.time_step > 0))
    throw ConfigError("solver.time_step",
                      "is missing: what follows from spacing and gravity, or from the fastest body, is no "
                      "number of single precision above 0; give it");
  return config.gravity.isZero() ? TimeStepSource::speed : TimeStepSource::gravity;
}

float default_viscosity(const SceneScale& scale, float time_step, const BodyState& body) {
  const float volume = body.spacing * body.spacing * body.spacing;
  return default_kinematic_viscosity(scale, time_step) * body.mass / volume;
}

/// That a default k suits [s].
float pressed_step(const Simulation::State& state) {
  return std::max(state.base_step(), state.longest_step());
}

/// Counted at a time: how many multiples of the period have passed.
double passed_periods(const Simulation::State& state, double time) {
  const double tolerance = k_tolerance * static_cast<double>(state.base_step());
  return std::floor((time + tolerance) / update_period(state));
}

/// ζ of a body that hardly moves in 1/Δt0, and the speed in h/Δt0 at which it is half of that. An elastic
/// cube of 8³ dropped from 10 h rebounds to 97% of what it would without, and one dropped from its own height
/// is slower than 1e-3 h a step after 60 s; a constant ζ that calms as fast takes half of the first rebound.
constexpr float k_calming = 0.3f, k_calm_speed = 0.02f;

/// Checks are every so many steps, as the paper has it, and not at times.
bool counts_steps(const SolverConfig& config) {
  return config.update_interval && config.time_step_factor == 1.0f;
}

}  // namespace

float largest_norm(const VectorColumn& vectors) {
  float largest = 0;
  for (std::size_t i = 0; i < vectors.size(); ++i) largest = std::max(largest, vectors.get(i).norm());
  return largest;
}

void resolve_settings(Simulation::State& state) {
  if (state.scale.spacing == 0) {
    SceneScale scale{.spacing = std::numeric_limits<float>::max(), .gravity = state.config.gravity};
    for (const BodyState& body : state.bodies) scale.spacing = std::min(scale.spacing, body.spacing);
    scale.speed = fastest_speed(state);
    SolverConfig config = state.config;
    const TimeStepSource source = resolve_time_step(scale, config);
    Checks checks;
    for (const MaterialState& material : state.materials) {
      check_stiffness(config, material.settings, checks);
      if (!material.settings.pressure_coefficient &&
          !std::isfinite(default_pressure_coefficient(config.support_radius, 0, 0, *config.time_step)))
        checks.problem("material.pressure_coefficient",
                       "is missing: what follows from support_radius and time_step is no number of single "
                       "precision; give it");
    }
    for (const BodyState& body : state.bodies)
      if (!body.material->settings.viscosity &&
          !std::isfinite(default_viscosity(scale, *config.time_step, body)))
        checks.problem("material.viscosity",
                       "is missing: what follows from spacing, gravity and mass is no number of single "
                       "precision; give it");
    checks.finish();
    state.config = config;
    state.scale = scale;
    state.time_step_source = source;
  }
  const float threshold = default_update_threshold(state.scale, state.base_step());
  for (MaterialState& material : state.materials)
    material.update_threshold = material.settings.update_threshold.value_or(threshold);
  for (BodyState& body : state.bodies)
    if (const auto& thins = body.material->settings.viscosity_by_temperature)
      body.viscosity = thins->highest();
    else
      body.viscosity =
          body.material->settings.viscosity.value_or(default_viscosity(state.scale, state.base_step(), body));
}

float pressure_coefficient(const Simulation::State& state, const MaterialState& material) {
  if (material.settings.pressure_coefficient) return *material.settings.pressure_coefficient;
  const float time_step = pressed_step(state);
  const float pull = state.stiffness(material, material.most_elasticity) * time_step * time_step;
  return default_pressure_coefficient(state.config.support_radius, material.most_alpha, pull, time_step);
}

void resolve_pressures(Simulation::State& state) {
  for (const BodyState& body : state.bodies) {
    const MaterialState& material = *body.material;
    SphGroup& sums = state.sph.groups[body.sph_group];
    sums.pressure_coefficient = pressure_coefficient(state, material);
    sums.contact_share = 1;
    sums.cohesion = material.settings.cohesion;
    if (material.settings.pressure_coefficient) continue;
    sums.contact_share = contact_share(material.most_alpha);
    sums.cohesion *=
        cohesive_share(state.config.support_radius, sums.pressure_coefficient, pressed_step(state));
  }
}

float Simulation::State::deformation_damping(const BodyState& body) const {
  if (body.material->settings.deformation_damping) return *body.material->settings.deformation_damping;
  if (body.yielded) return 0;
  const float ratio =
      static_cast<float>(body.rigid.deformation_speed) * base_step() / (k_calm_speed * body.spacing);
  return k_calming / (base_step() * (1 + ratio * ratio));
}

double update_period(const Simulation::State& state) {
  const SolverConfig& config = state.config;
  if (config.update_period) return static_cast<double>(*config.update_period);
  if (config.update_interval) return *config.update_interval * static_cast<double>(state.base_step());
  return default_update_period(state.base_step());
}

bool update_is_due(const Simulation::State& state) {
  if (counts_steps(state.config)) return state.step > 0 && state.step % *state.config.update_interval == 0;
  return passed_periods(state, state.time) > state.passed_periods;
}

double external_weight(const Simulation::State& state, float time_step) {
  if (counts_steps(state.config)) return (state.step + 1) % *state.config.update_interval == 0 ? 1.0 : 0.0;
  const double start = state.time, end = start + static_cast<double>(time_step);
  const double window = static_cast<double>(state.base_step());
  // The check that comes next, or the last one of several in this step.
  const double next = std::max(passed_periods(state, start) + 1, passed_periods(state, end));
  const double check = next * update_period(state);
  const double overlap = std::min(end, check) - std::max(start, check - window);
  return overlap > 0.5 * k_tolerance * window ? overlap : 0.0;
}

void add_external(Simulation::State& state) {
  const bool judged = update_is_due(state);
  for (BodyState& body : state.bodies) {
    if (judged) body.external_sum = body.external_weight = 0;
    body.external_sum += body.step_weight * body.step_external;
    body.external_weight += body.step_weight;
  }
  if (!counts_steps(state.config)) state.passed_periods = passed_periods(state, state.time);
}

}  // namespace mallow

#include "simulation/settings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "colliders/pose.h"
#include "config/field_tables.h"
#include "config/validation.h"
#include "simulation/phases.h"
#include "simulation/state.h"
#include "simulation/stiffness.h"

namespace mallow {
namespace {

/// Shares of Δt0 by which times may miss a multiple of the period: far above what their sums are off by.
constexpr double k_tolerance = 1e-6;

/// Time between looks for tears, in Δt0: gravity moves what it lets go of by a seventieth of a spacing,
/// so that no gap closes unseen unless something drives it.
constexpr double k_tear_look = 2;

/// What moves fastest at the start [m/s].
float fastest_speed(const Simulation::State& state) {
  float speed = largest_norm(state.store.velocity);
  for (const Collider& collider : state.colliders)
    speed = std::max(speed, static_cast<float>(greatest_speed(collider)));
  for (const PinState& pin : state.pins) speed = std::max(speed, pin.velocity.norm());
  return speed;
}

/// Settles Δt0 of `config`.
TimeStepSource resolve_time_step(const Simulation::State& state, const SceneScale& scale,
                                 SolverConfig& config) {
  if (config.time_step) return TimeStepSource::given;
  config.time_step = default_time_step(scale);
  double carried = std::numeric_limits<double>::infinity();
  for (const BodyState& body : state.bodies)
    carried = std::min(carried, modulus_time_step(config, body.material->settings, body.spacing,
                                                  painted_elasticity(state, body)));
  const bool is_shorter =
      std::isfinite(carried) && !(config.time_step && static_cast<double>(*config.time_step) <= carried);
  if (is_shorter) config.time_step = static_cast<float>(carried);
  if (!config.time_step)
    throw ConfigError("solver.time_step",
                      "is missing: without gravity, and where nothing moves, nothing says how long a second "
                      "is; give it, a number of seconds above 0");
  if (!(std::isfinite(*config.time_step) && *config.time_step > 0))
    throw ConfigError("solver.time_step",
                      "is missing: what follows from spacing and gravity, or from the fastest body, is no "
                      "number of single precision above 0; give it");
  if (is_shorter) return TimeStepSource::modulus;
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

/// How many multiples of a period have passed at a time.
double passed(const Simulation::State& state, double time, double period) {
  const double tolerance = k_tolerance * static_cast<double>(state.base_step());
  return std::floor((time + tolerance) / period);
}
/// Counted at a time: those of the checks.
double passed_periods(const Simulation::State& state, double time) {
  return passed(state, time, update_period(state));
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

namespace {

/// Of bodies of one material and spacing the first speaks for all.
void check_moduli(const Simulation::State& state, const SolverConfig& config, Checks& checks) {
  std::set<std::pair<const MaterialState*, float>> checked;
  for (const BodyState& body : state.bodies)
    if (checked.emplace(body.material, body.spacing).second)
      check_modulus(config, body.material->settings, body, checks);
}

/// Spacing and speeds -> scale, support_radius, time_step and its source.
void settle(Simulation::State& state) {
  SceneScale scale{.spacing = std::numeric_limits<float>::max(), .gravity = state.config.gravity};
  for (const BodyState& body : state.bodies) scale.spacing = std::min(scale.spacing, body.spacing);
  scale.speed = fastest_speed(state);
  SolverConfig config = state.config;
  float coarsest = 0;
  for (const BodyState& body : state.bodies) coarsest = std::max(coarsest, body.spacing);
  if (!config.support_radius) config.support_radius = default_support_radius(coarsest);
  const TimeStepSource source = resolve_time_step(state, scale, config);
  Checks checks;
  for (const MaterialState& material : state.materials) {
    if (!material.is_there()) continue;
    check_stiffness(config, material.settings, material.name, checks);
    if (!material.settings.pressure_coefficient &&
        !std::isfinite(default_pressure_coefficient(*config.support_radius, 0, 0, *config.time_step)))
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
  check_moduli(state, config, checks);
  checks.finish();
  const bool is_new_radius = !state.config.support_radius;
  state.config = config;
  if (is_new_radius) {
    take_support_radius(state);
    for (BodyState& body : state.bodies) {
      derive_density(config, body);
      body.shape.region_radius = region_radius(config, body.material->settings, body.spacing);
    }
  }
  state.scale = scale;
  state.time_step_source = source;
}

}  // namespace

void resolve_settings(Simulation::State& state) {
  if (state.scale.spacing == 0) settle(state);
  Checks checks;
  check_moduli(state, state.config, checks);
  checks.finish();
  const float threshold = default_update_threshold(state.scale, state.scene_step());
  for (MaterialState& material : state.materials)
    material.update_threshold = material.settings.update_threshold.value_or(threshold);
  for (BodyState& body : state.bodies) {
    const Material& settings = body.material->settings;
    body.viscosity =
        settings.viscosity_by_temperature
            ? settings.viscosity_by_temperature->highest()
            : settings.viscosity.value_or(default_viscosity(state.scale, state.scene_step(), body));
    body.elastic_time_step = elastic_time_step(state.config, settings, body.spacing);
  }
}

bool changes_while_running(std::string_view field) {
  static constexpr std::string_view k_changing[] = {
      "time_step_factor", "gravity",     "rotation_iterations", "volume_tolerance", "neighbor_slack",
      "acoustic_limit",   "sleep_speed", "sleep_time",          "air_temperature",  "memory_limit"};
  return std::ranges::find(k_changing, field) != std::end(k_changing);
}

namespace {

void check_kept(const SolverConfig& before, const SolverConfig& now, Checks& checks) {
  for_fields<SolverConfig>([&](const auto& field) {
    if constexpr (requires { before.*field.member == now.*field.member; })
      if (!changes_while_running(field.name) && !(before.*field.member == now.*field.member))
        checks.problem(std::string("solver.") + field.name,
                       "cannot change while a simulation runs; build the scene anew with it");
  });
}

}  // namespace

void change_solver(Simulation::State& state, const SolverConfig& config) {
  Checks checks;
  check(config, checks);
  check_kept(state.config, config, checks);
  checks.finish();
  if (config.time_step)
    for (const MaterialState& material : state.materials)
      if (material.is_there()) check_stiffness(config, material.settings, material.name, checks);
  if (config.time_step) check_moduli(state, config, checks);
  checks.finish();
  const bool counted = counts_steps(state.config);
  if (state.config.gravity != config.gravity) wake_all(state);
  state.config = config;
  state.sph.neighbor_slack = config.neighbor_slack;
  // Checks that were counted in steps go on by time, from now.
  if (counted && !counts_steps(config)) state.passed_periods = passed_periods(state, state.time);
  state.prepared = false;
}

float pressure_coefficient(const Simulation::State& state, const BodyState& body) {
  const MaterialState& material = *body.material;
  if (material.settings.pressure_coefficient) return *material.settings.pressure_coefficient;
  const float time_step = pressed_step(state);
  const float pull = state.stiffness(body, material.most_elasticity) * time_step * time_step;
  return default_pressure_coefficient(state.support_radius(), material.most_alpha, pull, time_step);
}

void resolve_pressures(Simulation::State& state) {
  for (const BodyState& body : state.bodies) {
    const MaterialState& material = *body.material;
    SphGroup& sums = state.sph.groups[body.sph_group];
    sums.pressure_coefficient = pressure_coefficient(state, body);
    sums.contact_share = 1;
    sums.cohesion = material.settings.cohesion;
    if (material.settings.pressure_coefficient) continue;
    sums.contact_share = contact_share(material.most_alpha);
    sums.cohesion *= cohesive_share(state.support_radius(), sums.pressure_coefficient, pressed_step(state));
  }
}

float Simulation::State::deformation_damping(const BodyState& body) const {
  if (body.material->settings.deformation_damping) return *body.material->settings.deformation_damping;
  if (body.apart) return 0;
  const float ratio =
      static_cast<float>(body.rigid.deformation_speed) * scene_step() / (k_calm_speed * body.spacing);
  return k_calming / (scene_step() * (1 + ratio * ratio));
}

int Simulation::State::volume_iterations() const {
  const bool any_flows =
      std::ranges::any_of(bodies, [](const BodyState& body) { return flows(body.material->settings); });
  return config.volume_iterations.value_or(default_volume_iterations(any_flows));
}

double update_period(const Simulation::State& state) {
  const SolverConfig& config = state.config;
  if (config.update_period) return static_cast<double>(*config.update_period);
  if (config.update_interval) return *config.update_interval * static_cast<double>(state.base_step());
  return default_update_period(state.scene_step());
}

bool update_is_due(const Simulation::State& state) {
  if (counts_steps(state.config)) return state.step > 0 && state.step % *state.config.update_interval == 0;
  return passed_periods(state, state.time) > state.passed_periods;
}

bool tear_look_is_due(const Simulation::State& state) {
  const double period = k_tear_look * static_cast<double>(state.scene_step());
  return passed(state, state.time, period) > passed(state, state.time - state.last_time_step, period);
}

bool is_judged(const Simulation::State& state) {
  return !counts_steps(state.config) || (state.step + 1) % *state.config.update_interval == 0;
}

namespace {

/// The mean over the last Δt0, of as much of it as there is. Steps before it are forgotten.
double recent_mean(double window, std::vector<BodyState::External>& recent) {
  double sum = 0, seconds = 0;
  std::size_t k = recent.size();
  for (; k > 0 && seconds < window * (1 - k_tolerance); --k) {
    const double shared = std::min(recent[k - 1].seconds, window - seconds);
    sum += shared * recent[k - 1].mean;
    seconds += shared;
  }
  recent.erase(recent.begin(), recent.begin() + static_cast<std::ptrdiff_t>(k));
  return sum / window;
}

}  // namespace

void add_external(Simulation::State& state, double time_step) {
  const bool judged = update_is_due(state);
  for (BodyState& body : state.bodies) {
    if (judged) {
      body.judged_external = 0;
      body.recent_external.clear();
    }
    if (!body.measures_external) continue;
    if (counts_steps(state.config)) {
      body.judged_external = body.step_external;
      continue;
    }
    body.recent_external.push_back({time_step, body.step_external});
    body.judged_external = std::max(
        body.judged_external, recent_mean(static_cast<double>(state.scene_step()), body.recent_external));
  }
  if (!counts_steps(state.config)) state.passed_periods = passed_periods(state, state.time);
}

}  // namespace mallow

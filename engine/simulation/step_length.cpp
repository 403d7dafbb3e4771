// How long a step may be: what its particles, pressure, viscosity and damping allow. [TK eq. 12]
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/checks.h"
#include "simulation/damage.h"
#include "simulation/phases.h"
#include "simulation/settings.h"
#include "simulation/state.h"

namespace mallow {
namespace {

/// Steps shorter than this share of the longest mean that a setting is wrong, not that patience is needed.
constexpr double k_shortest_step = 1e-3;

/// σ² ρ0/μ [s]; infinite without viscosity.
float viscous_time(const Simulation::State& state, const BodyState& body) {
  if (!(body.viscosity > 0)) return std::numeric_limits<float>::infinity();
  return state.support_radius() * state.support_radius() * body.rest_density / body.viscosity;
}

/// Pressure, viscosity and pull of a body as they act.
TimeStepLimits::Pressure acting_pressure(const Simulation::State& state, const BodyState& body) {
  // Other bodies feel the whole pressure, whatever this one's alpha, unless it follows alpha.
  const bool follows = !body.material->settings.pressure_coefficient;
  const bool presses = state.bodies.size() > 1 && !state.sph.apart;
  const float push =
      presses ? (follows ? contact_share(body.material->most_alpha) : 1.0f) : body.most_alpha();
  const float drag = presses ? 1.0f : body.most_alpha();
  const float coefficient = push * pressure_coefficient(state, body);
  return {.coefficient = coefficient,
          .kinematic_viscosity = drag * body.viscosity / body.rest_density,
          .stiffness = state.most_stiffness(body),
          .pull = follows ? 0.0f : body.material->settings.cohesion * coefficient,
          .damping_time = body.material->settings.damping_time,
          .damping_rate = body.material->settings.deformation_damping.value_or(0.0f)};
}

/// How far a particle may move in a step: not beyond what SPH reaches, and where bodies touch not so far that
/// two could pass each other before either is looked for. [TK eq. 12]
float farthest_move(const Simulation::State& state) {
  const float radius = state.support_radius();
  if (!state.bodies_touch()) return radius;
  return radius - 0.5f * std::ranges::max_element(state.bodies, {}, &BodyState::spacing)->spacing;
}

/// pressures: where those of the bodies are kept.
TimeStepLimits limits(const Simulation::State& state, std::vector<TimeStepLimits::Pressure>& pressures) {
  TimeStepLimits limits{
      .time_step = state.longest_step(),
      .support_radius = state.support_radius(),
      .farthest = farthest_move(state),
      .acoustic = state.config.acoustic_limit,
      .pressures = {},
      .viscous_time = std::numeric_limits<float>::infinity(),
  };
  pressures.clear();
  for (const BodyState& body : state.bodies) {
    pressures.push_back(acting_pressure(state, body));
    limits.viscous_time = std::min(limits.viscous_time, viscous_time(state, body));
  }
  limits.pressures = pressures;
  return limits;
}

[[noreturn]] void refuse_short_step(const Simulation::State& state, double time_step, double velocity,
                                    std::uint32_t row) {
  std::ostringstream text = describe_particle(state, row);
  text << "would move at " << velocity << " m/s and needs a step of " << time_step
       << " s, below a thousandth of the longest, "
       << k_shortest_step * static_cast<double>(state.longest_step()) << " s";
  if (velocity > fastest_carried(state))
    text << ", and no step carries more than " << fastest_carried(state) << " m/s";
  text << "; lower material.pressure_coefficient or viscosity, raise solver.support_radius, or lower "
          "solver.time_step (now "
       << state.base_step() << ")";
  throw StepError(text.str(), state.store.id[row], Phase::time_step);
}

/// V, and who is that fast.
Fastest find_fastest(Simulation::State& state) {
  FastestInput& input = state.fastest;
  input.time_step = state.longest_step();
  input.gravity = state.config.gravity;
  input.sph_acceleration = state.sph_ran ? &state.sph.acceleration : nullptr;
  input.cross_group = state.cross_group();
  input.walls = state.walls();
  input.user = state.user();
  input.bodies.clear();
  for (const BodyState* moving : state.awake) {
    const BodyState& body = *moving;
    // The paper's bound takes the whole acceleration, of which alpha acts. A k that is left out grows as
    // alpha falls: steps would be shortened, and varied, by what does not act.
    // Where particles differ it is blended already.
    const bool whole = body.material->settings.pressure_coefficient || state.is_painted();
    const float share = whole ? 1.0f : body.material->alpha;
    input.bodies.push_back({body.begin, body.end, share});
  }
  return fastest_particle(state.store, state.execution, input);
}

/// The longest step that velocities and accelerations allow.
float longest_time_step(Simulation::State& state, StepReport& report) {
  const float longest = state.longest_step();
  if (!state.density_ran && !state.bodies_touch()) return longest;
  const Fastest fastest = find_fastest(state);
  const double velocity =
      fastest.squared_velocity == -1 ? 0.0 : std::sqrt(static_cast<double>(fastest.squared_velocity));
  const double step = limited_time_step(limits(state, state.pressures), velocity);
  if (!std::isfinite(velocity)) refuse_damage(state, Phase::time_step, fastest.row);
  if (step < k_shortest_step * static_cast<double>(longest))
    refuse_short_step(state, step, velocity, fastest.row);
  report.max_velocity = velocity;
  report.limited = static_cast<float>(step) < longest;
  return static_cast<float>(step);
}

}  // namespace

MaterialLimits material_limits(const Simulation::State& state, const BodyState& body) {
  TimeStepLimits none{.time_step = std::numeric_limits<float>::infinity(),
                      .support_radius = state.support_radius(),
                      .farthest = std::numeric_limits<float>::infinity(),  // of no meaning at rest
                      .acoustic = state.config.acoustic_limit,
                      .pressures = {},
                      .viscous_time = std::numeric_limits<float>::infinity()};
  TimeStepLimits pressed = none, viscous = none;
  const TimeStepLimits::Pressure pressure[] = {acting_pressure(state, body)};
  pressed.pressures = pressure;
  viscous.viscous_time = viscous_time(state, body);
  return {.by_pressure = limited_time_step(pressed, 0), .by_viscosity = limited_time_step(viscous, 0)};
}

double unlimited_step(const Simulation::State& state) {
  if (!state.needs_sph() && !state.keeps_volume()) return std::numeric_limits<double>::infinity();
  std::vector<TimeStepLimits::Pressure> pressures;
  TimeStepLimits bounds = limits(state, pressures);
  bounds.time_step = std::numeric_limits<float>::infinity();
  return limited_time_step(bounds, static_cast<double>(largest_norm(state.store.velocity)));
}

double fastest_carried(const Simulation::State& state) {
  // What is faster has no square that is a float.
  static const double k_fastest = std::sqrt(static_cast<double>(std::numeric_limits<float>::max()));
  const bool is_settled = state.scale.spacing > 0;
  const bool is_limited = is_settled && (state.needs_sph() || state.keeps_volume() || state.bodies_touch());
  if (!is_limited) return k_fastest;
  return static_cast<double>(farthest_move(state)) /
         (k_shortest_step * static_cast<double>(state.longest_step()));
}

void check_speed(const Simulation::State& state, const char* field, double speed, Checks& checks) {
  const double fastest = fastest_carried(state);
  if (speed <= fastest) return;
  std::ostringstream text;
  text << speed << " m/s is not allowed: no step carries more than " << fastest << " m/s";
  checks.problem(field, text.str());
}

void check_speeds(const Simulation::State& state) {
  Checks checks;
  for (const PinState& pin : state.pins)
    check_speed(state, "pin.velocity", pin.velocity.cast<double>().norm(), checks);
  check_speed(state, "body.velocity", static_cast<double>(largest_norm(state.store.velocity)), checks);
  checks.finish();
}

void Simulation::State::require_ahead(double end) const {
  if (end > time) return;
  std::ostringstream text;
  text << end << " is not allowed: a time after the present one, " << time << " s";
  throw ConfigError("end", text.str());
}

ChosenStep choose_time_step(Simulation::State& state, double end, StepReport& report) {
  float time_step = longest_time_step(state, report);
  bool lands = false;
  if (const double left = end - state.time; std::isfinite(left)) {
    const double steps = steps_until(left, static_cast<double>(time_step));
    time_step = share_of(left, steps);
    lands = steps == 1;
  }
  report.time_step = static_cast<double>(time_step);
  return {time_step, lands ? end : state.time + report.time_step};
}

}  // namespace mallow

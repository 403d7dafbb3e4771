#include "mallow/defaults.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "config/validation.h"
#include "simulation/settings.h"

namespace mallow {
namespace {

/// What suits SPH and regions, in spacings: 32 to 39 neighbours.
constexpr float k_usual_radius = 2.1f;
/// Δt0 = this √(h/|g|): exactly the paper's 0.15 at its spacing of 1 and its gravity of 0.3, as single
/// precision has the two.
const double k_fall = static_cast<double>(0.15f) * std::sqrt(static_cast<double>(0.3f));
/// Spacings a step of the fastest body without gravity: a fall of 7 to 10 spacings at the Δt0 above ends at
/// 0.3 to 0.37.
constexpr double k_flight = 0.3;
/// γ_u in |g|: 12 at the paper's gravity.
constexpr double k_threshold = 40;
/// γ_u in h/Δt0², the same number: 40 · 0.15² · 0.3.
constexpr double k_threshold_of_step = 0.27;
/// Steps between checks, the paper's 60.
constexpr double k_check_steps = 60;
/// ν in h √(|g| h), and in h²/Δt0: exactly the paper's 0.5 at its numbers, as above.
const double k_viscosity = 0.5 / std::sqrt(static_cast<double>(0.3f));
constexpr double k_viscosity_of_step = 0.5 * static_cast<double>(0.15f);
/// 2 x + (1 − α) Δt²/(Δt0 Δt_SM), above the 2.5 that elasticity may take of it.
constexpr double k_together = 2.6;
/// k of negative pressures in σ²/Δt²: the paper's 16. At full stiffness particles shot out of a body at
/// rest, as the surface of a lattice is 40% less dense than its middle.
constexpr double k_cohesive = 0.08;
/// Alpha below which k grows no more. [TK eq. 12] bounds steps by the whole acceleration of SPH, of which
/// alpha acts: with k for alpha 0.05 an impact shortened steps to a quarter, and densities of 1.8 stayed.
constexpr float k_least_alpha = 0.2f;

/// Iterations of the volume constraint where matter flows. A cube of 10 cm of clay without alpha, dropped
/// from 20 cm, ends in crumbs up to 3.5 m off without, and within 30 cm with 2. With alpha from 0.4,
/// toothpaste at spacings of 10 and 6.3 mm ends at heights 8% apart with none, 2% with 1, 2, 3, or to a mean
/// of 0.1%.
constexpr int k_flow_iterations = 2;

double length(const Vec3& v) {
  return v.cast<double>().norm();
}

}  // namespace

std::optional<float> default_time_step(const SceneScale& scale) {
  const double h = static_cast<double>(scale.spacing), g = length(scale.gravity);
  if (g > 0) return static_cast<float>(k_fall * std::sqrt(h / g));
  if (scale.speed > 0) return static_cast<float>(k_flight * h / static_cast<double>(scale.speed));
  return std::nullopt;
}

float default_support_radius(float spacing) {
  return k_usual_radius * spacing;
}

float default_update_threshold(const SceneScale& scale, float time_step) {
  const double g = length(scale.gravity), dt = static_cast<double>(time_step);
  if (g > 0) return static_cast<float>(k_threshold * g);
  return static_cast<float>(k_threshold_of_step * static_cast<double>(scale.spacing) / (dt * dt));
}

double default_update_period(float time_step) {
  return k_check_steps * static_cast<double>(time_step);
}

float default_pressure_coefficient(float support_radius, float alpha, float pull, float time_step) {
  const double asked = static_cast<double>(pull), carried = std::min(asked, static_cast<double>(k_stiffest));
  const double share = std::min(1.0, 0.5 * (k_together - carried));
  const double shorter = asked > carried ? std::sqrt(carried / asked) : 1;
  const double speed = static_cast<double>(support_radius) / (shorter * static_cast<double>(time_step));
  return static_cast<float>(share * speed * speed / static_cast<double>(contact_share(alpha)));
}

float default_kinematic_viscosity(const SceneScale& scale, float time_step) {
  const double h = static_cast<double>(scale.spacing), g = length(scale.gravity);
  if (g > 0) return static_cast<float>(k_viscosity * h * std::sqrt(g * h));
  return static_cast<float>(k_viscosity_of_step * h * h / static_cast<double>(time_step));
}

int default_volume_iterations(bool flows) {
  return flows ? k_flow_iterations : 0;
}

double full_neighbors(float radius, float spacing) {
  return 4.0 / 3.0 * std::numbers::pi *
         std::pow(static_cast<double>(radius) / static_cast<double>(spacing), 3);
}

float cohesive_share(float support_radius, float pressure_coefficient, float time_step) {
  const double speed = static_cast<double>(support_radius) / static_cast<double>(time_step);
  return static_cast<float>(
      std::min(1.0, k_cohesive * speed * speed / static_cast<double>(pressure_coefficient)));
}

float contact_share(float alpha) {
  return std::max(alpha, k_least_alpha);
}

}  // namespace mallow

#include "simulation/stiffness.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>

#include "mallow/defaults.h"
#include "simulation/settings.h"
#include "simulation/state.h"

namespace mallow {
namespace {

/// Beyond so many spacings the sum is the integral, 0.2 r², to a thousandth.
constexpr double k_dense = 64;
/// Of a step's pull, where the step follows from Y.
constexpr double k_default_pull = 1;
/// Of the most that the longest step carries, where time_step_factor would go beyond.
constexpr double k_room = 0.99;
constexpr double k_rounding = 1e-5;  // of what is typed with six digits

/// 1 − α, at most.
double elastic_share(const Material& material) {
  return 1 - static_cast<double>(lowest_alpha(material));
}

bool is_elastic(const Material& material) {
  return material.youngs_modulus && !material.alpha.keys().empty() && elastic_share(material) > 0;
}

/// Y/(ρ m2) times the share of it that acts [1/s²], of which steps take Δt² times.
double pull_rate(const SolverConfig& config, const Material& material, float spacing, double share) {
  return share * static_cast<double>(*material.youngs_modulus) / stiffness_scale(config, material, spacing);
}

/// The step whose pull, damping and all, is `most`: the root of rate (Δt² + 2 τ Δt) = most.
double step_of_pull(double rate, double damping_time, double most) {
  const double square = most / rate;
  return square / (damping_time + std::sqrt(damping_time * damping_time + square));
}

}  // namespace

double region_moment(double radius, double spacing) {
  if (radius > k_dense * spacing) return 0.2 * radius * radius;
  const auto reach = static_cast<int>(radius / spacing);
  const double most = radius * radius / (spacing * spacing);
  std::int64_t sum = 0, points = 0;
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x)
        if (x * x + y * y + z * z <= most) {
          sum += x * x;
          ++points;
        }
  return spacing * spacing * static_cast<double>(sum) / static_cast<double>(points);
}

double stiffness_scale(const SolverConfig& config, const Material& material, float spacing) {
  const double h = static_cast<double>(spacing);
  const double mass = static_cast<double>(particle_density(config, material, spacing).mass);
  return mass / (h * h * h) * region_moment(static_cast<double>(region_radius(config, material, spacing)), h);
}

float elastic_time_step(const SolverConfig& config, const Material& material, float spacing) {
  if (!material.youngs_modulus) return material.elastic_time_step.value_or(*config.time_step);
  return static_cast<float>(
      stiffness_scale(config, material, spacing) /
      (static_cast<double>(*material.youngs_modulus) * static_cast<double>(*config.time_step)));
}

Material with_springs(const SolverConfig& config, const Material& material, float spacing) {
  Material springs = material;
  springs.elastic_time_step = elastic_time_step(config, material, spacing);
  springs.youngs_modulus.reset();
  return springs;
}

float lowest_alpha(const Material& material) {
  return material.alpha_by_temperature.value_or(material.alpha).lowest();
}

double most_modulus(const SolverConfig& config, const Material& material, float spacing) {
  const double share = 1 - static_cast<double>(lowest_alpha(material));
  if (!(share > 0)) return std::numeric_limits<double>::infinity();
  const double step = static_cast<double>(config.time_step_factor) * static_cast<double>(*config.time_step);
  const double time = static_cast<double>(material.damping_time);
  const double pull = std::max((step + 2 * time) / static_cast<double>(k_stiffest),
                               step / static_cast<double>(most_pull(material)));
  return stiffness_scale(config, material, spacing) / (share * step * pull);
}

double modulus_time_step(const SolverConfig& config, const Material& material, float spacing,
                         double painted) {
  const double share = std::max(elastic_share(material), painted);
  if (!material.youngs_modulus || material.alpha.keys().empty() || !(share > 0))
    return std::numeric_limits<double>::infinity();
  const double factor = static_cast<double>(config.time_step_factor);
  const double most = static_cast<double>(most_pull(material)) / (factor * factor);
  return step_of_pull(pull_rate(config, material, spacing, share), static_cast<double>(material.damping_time),
                      std::min(k_default_pull, k_room * most));
}

void check_modulus(const SolverConfig& config, const Material& material, const BodyState& body,
                   Checks& checks) {
  const float spacing = body.spacing;
  // Where particles have no neighbours, that is what is told.
  if (!config.time_step || !is_elastic(material) || spacing >= config.support_radius) return;
  const std::string where = "body '" + body.name + "' of material '" + body.material->name + "'";
  const auto is_too_stiff = [&](const Material& one) {
    return static_cast<double>(*one.youngs_modulus) > most_modulus(config, one, spacing) * (1 + k_rounding);
  };
  Material undamped = material;
  undamped.damping_time = 0;
  if (is_too_stiff(undamped)) {
    const double most = most_modulus(config, material, spacing);
    const double factor = static_cast<double>(config.time_step_factor);
    const double rate = pull_rate(config, material, spacing, elastic_share(material));
    const double step = std::min(
        step_of_pull(rate, static_cast<double>(material.damping_time), static_cast<double>(k_stiffest)),
        step_of_pull(rate, 0, static_cast<double>(most_pull(material))));
    std::ostringstream text;
    text.precision(3);
    text << *material.youngs_modulus << " is not allowed in " << where << ", whose spacing is " << spacing
         << " m: at most " << most << " Pa in steps of " << factor * static_cast<double>(*config.time_step)
         << " s, as a stiffer body would gain energy; lower it, or ";
    if (factor > 1)
      text << "solver.time_step_factor (now " << factor << ") to "
           << 0.99 * step / static_cast<double>(*config.time_step) << ", or ";
    text << "solver.time_step to " << 0.99 * step / factor << " s";
    return checks.problem("material.youngs_modulus", text.str());
  }
  // What is too stiff by its damping alone is damped too much.
  check_damping(config, with_springs(config, material, spacing), where, "a lower material.youngs_modulus",
                checks);
}

}  // namespace mallow

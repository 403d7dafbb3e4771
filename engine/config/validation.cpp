#include "config/validation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <vector>

#include "config/field_checks.h"
#include "config/field_tables.h"
#include "core/precision.h"

namespace mallow {

void check(const SolverConfig& config, Checks& checks) {
  check_fields("solver.", config, checks);
  if (config.update_period && config.update_interval)
    checks.problem("solver.update_interval", "is not allowed beside update_period: give one of the two");
  if (config.instruction_level) check(*config.instruction_level, best_instruction_level(), checks);
}

void check(InstructionLevel level, InstructionLevel best, Checks& checks) {
  if (level >= InstructionLevel::baseline && level <= best) return;
  std::string has;
  for (const InstructionLevel one : k_instruction_levels)
    if (one <= best) has += (has.empty() ? "" : ", ") + std::string(name(one));
  checks.problem("solver.instruction_level",
                 std::string(name(level)) + " is not allowed: this machine has " + has);
}

void check(const AlphaSchedule& alpha, Checks& checks) {
  check_value("material.alpha", alpha, range_of(&Material::alpha), checks);
}

void check(const Material& material, Checks& checks) {
  check_fields("material.", material, checks);
  if (material.plastic_creep && !flows(material))
    checks.problem("material.plastic_creep",
                   "is not allowed without plastic_yield: give the strain beyond which it flows, 0 or above");
  const bool melts = material.solidus && material.liquidus && *material.liquidus > *material.solidus;
  if (material.latent_heat > 0 && !melts)
    checks.problem("material.latent_heat", "needs a solidus, and a liquidus above it");
  const char* const follower = material.alpha_by_temperature           ? "alpha_by_temperature"
                               : material.viscosity_by_temperature     ? "viscosity_by_temperature"
                               : material.plastic_yield_by_temperature ? "plastic_yield_by_temperature"
                                                                       : nullptr;
  if (!material.temperature && follower)
    checks.problem("material.temperature",
                   std::string("is missing: ") + follower +
                       " needs the temperature of the particles at the start, a number in kelvins; 293 is "
                       "that of a room");
  if (material.youngs_modulus && material.elastic_time_step)
    checks.problem("material.youngs_modulus", "is not allowed beside elastic_time_step: give one of the two");
}

namespace {

std::string not_allowed_in(const std::string& where) {
  return " is not allowed" + (where.empty() ? std::string() : " in " + where);
}

std::string material_named(const std::string& name) {
  return name.empty() ? std::string() : "material '" + name + "'";
}

}  // namespace

/// Damping takes its part of the pull that a step carries. With θ = τ/Δt and s = 1 − exp(−ζ Δt), linear
/// theory has a (1 + 2 θ) < 4 − 2 s; tumbling bodies ask for k_stiffest.
void check_damping(const SolverConfig& config, const Material& material, const std::string& where,
                   const char* softer, Checks& checks) {
  const double rate = static_cast<double>(material.deformation_damping.value_or(0.0f));
  if (!config.time_step || !(material.damping_time > 0 || rate > 0)) return;
  const double base = static_cast<double>(*config.time_step);
  const double step = static_cast<double>(config.time_step_factor) * base;
  const double elastic_step = static_cast<double>(material.elastic_time_step.value_or(*config.time_step));
  const double pull =
      (1 - static_cast<double>(material.alpha.lowest())) * step * step / (base * elastic_step);
  const auto refuse = [&](const char* key, double value, double most) {
    std::ostringstream text;
    text << value << not_allowed_in(where) << ": at most " << std::max(0.0, most)
         << ", as a body damped more would gain energy in steps of " << step << " s; " << softer
         << ", which is softer, allows more";
    checks.problem(key, text.str());
  };
  const double time = static_cast<double>(material.damping_time);
  const double most_time = 0.5 * step * (static_cast<double>(k_stiffest) / pull - 1);
  if (time > most_time) refuse("material.damping_time", time, most_time);
  constexpr double k_linear = 0.9;
  const double most_share = 2 - 0.5 * pull * (1 + 2 * time / step) / k_linear;
  if (time <= most_time && most_share < 1 && -std::expm1(-rate * step) > most_share)
    refuse("material.deformation_damping", rate, -std::log1p(-most_share) / step);
}

void check_stiffness(const SolverConfig& config, const Material& material, const std::string& name,
                     Checks& checks) {
  const double most = static_cast<double>(most_pull(material));
  constexpr double k_rounding = 1e-5;  // of what is typed with six digits
  // What a modulus asks for is known once bodies are there: check_modulus().
  if (material.alpha.keys().empty() || material.youngs_modulus) return;
  const std::string where = material_named(name);
  check_damping(config, material, where, "a larger material.elastic_time_step", checks);
  // Left out, Δt_SM is Δt0, whatever that is; given, it is judged once that is known.
  if (material.elastic_time_step && !config.time_step) return;
  const double factor = static_cast<double>(config.time_step_factor);
  const double share = (1 - static_cast<double>(material.alpha.lowest())) * factor * factor / most;
  std::ostringstream text;
  if (!material.elastic_time_step) {
    if (share <= 1 + k_rounding) return;
    text << config.time_step_factor << not_allowed_in(where)
         << ": (1 - alpha) time_step_factor^2 must be at most " << most
         << ", as elasticity would gain energy; at alpha " << material.alpha.lowest() << " at most "
         << std::sqrt(most / (1 - static_cast<double>(material.alpha.lowest())));
    checks.problem("solver.time_step_factor", text.str());
    return;
  }
  const double least = share * static_cast<double>(*config.time_step);
  if (static_cast<double>(*material.elastic_time_step) >= least * (1 - k_rounding)) return;
  text << *material.elastic_time_step << not_allowed_in(where) << ": at least (1 - alpha) "
       << (factor == 1 ? "" : "time_step_factor^2 ") << "solver.time_step/" << most << " = " << least
       << ", as a stiffer body would gain energy; lower solver.time_step (now " << *config.time_step << ')';
  if (factor > 1) text << ", or solver.time_step_factor (now " << factor << ')';
  checks.problem("material.elastic_time_step", text.str());
}

namespace {

/// What the stiffest particle of a body asks of a step.
struct StiffestSpring {
  const SolverConfig& config;
  const Material& material;
  double base, elastic_step;  ///< Δt0 and Δt_SM [s]

  /// Shares of the modulus that steps of time_step_factor `shorter` Δt0 carry. What a modulus is in Δt_SM
  /// changes with Δt0; left out, Δt_SM is Δt0.
  double most_share(double shorter) const {
    const double own = shorter * base;
    const double step = static_cast<double>(config.time_step_factor) * own;
    const double springs = material.youngs_modulus      ? elastic_step / shorter
                           : material.elastic_time_step ? elastic_step
                                                        : own;
    return most_of(step) * own * springs / (step * step);
  }
  /// a that a step carries, beside its damping.
  double most_of(double step) const {
    constexpr double k_linear = 0.9;
    const double damped = 1 + 2 * static_cast<double>(material.damping_time) / step;
    const double rate = static_cast<double>(material.deformation_damping.value_or(0.0f));
    return std::min(
        std::min(static_cast<double>(k_stiffest), 2 * k_linear * (2 + std::expm1(-rate * step))) / damped,
        static_cast<double>(most_pull(material)));
  }
  /// Δt0 that carries a share, or 0 where no shorter one does [s].
  double base_for(double share) const {
    if (!material.youngs_modulus && !material.elastic_time_step) return 0;
    double carries = 1e-12, fails = 1;
    if (most_share(carries) < share) return 0;
    for (int k = 0; k < 100; ++k) {
      const double between = std::sqrt(carries * fails);
      (most_share(between) < share ? fails : carries) = between;
    }
    return 0.99 * carries * base;
  }
  /// Δt_SM that does, at this Δt0 [s].
  double elastic_step_for(double share) const { return 1.01 * elastic_step * share / most_share(1); }
};

}  // namespace

void check_elasticity(const SolverConfig& config, const Material& material, const Material& springs,
                      float share, Checks& checks) {
  if (!config.time_step) return;
  const double base = static_cast<double>(*config.time_step), asked = static_cast<double>(share);
  const StiffestSpring spring{config, material, base,
                              static_cast<double>(springs.elastic_time_step.value_or(*config.time_step))};
  const double most = spring.most_share(1);
  constexpr double k_rounding = 1e-5;
  if (asked <= most * (1 + k_rounding)) return;
  std::ostringstream text;
  text << "makes (1 - alpha) times stiffness " << share << " at some particle: at most " << most
       << " is allowed, as a stiffer body would gain energy; lower it";
  text.precision(3);
  if (const double step = spring.base_for(asked); step > 0)
    text << ", or solver.time_step (now " << base << ") to " << step << " s";
  if (config.time_step_factor > 1)
    text << ", or solver.time_step_factor (now " << config.time_step_factor << ')';
  if (material.youngs_modulus)
    text << ", or material.youngs_modulus";
  else
    text << ", or raise material.elastic_time_step to " << spring.elastic_step_for(asked) << " s";
  checks.problem("body.stiffness", text.str());
}

namespace {

/// Points of a nozzle at least a tenth of the spacing apart, as particles are.
void check_apart(const Emitter& emitter, Checks& checks) {
  const std::vector<Vec3>& points = emitter.points;
  // Less what rounding takes: where they come into the world they are looked at again.
  const double least = 0.1 * (1 - 1e-5) * static_cast<double>(emitter.spacing);
  std::vector<std::size_t> by_x(points.size());
  std::iota(by_x.begin(), by_x.end(), std::size_t{0});
  std::ranges::stable_sort(by_x, {}, [&](std::size_t k) { return points[k].x(); });
  for (std::size_t a = 0; a < by_x.size(); ++a)
    for (std::size_t b = a + 1; b < by_x.size(); ++b) {
      const Vec3 from = points[by_x[b]] - points[by_x[a]];
      if (!(static_cast<double>(from.x()) < least)) break;
      const double distance = std::hypot(static_cast<double>(from.x()), static_cast<double>(from.y()));
      if (!(distance < least)) continue;
      const auto [first, second] = std::minmax(by_x[a], by_x[b]);
      std::ostringstream text;
      text << "points " << first << " (" << points[first].transpose() << ") and " << second << " ("
           << points[second].transpose() << ") are " << distance
           << " m apart across the flow, at least a tenth of the spacing ("
           << 0.1 * static_cast<double>(emitter.spacing) << " m) is needed";
      return checks.problem("emitter.points", text.str());
    }
}

}  // namespace

void check(const Emitter& emitter, Checks& checks) {
  check_fields("emitter.", emitter, checks);
  const bool corners = emitter.width || emitter.height;
  const int given = emitter.radius.has_value() + corners + !emitter.points.empty();
  if (given == 0)
    checks.problem("emitter.radius",
                   "is missing: a number > 0, the radius of a round nozzle; or give width and height of one "
                   "with corners");
  if (given > 1)
    checks.problem("emitter.radius",
                   "is not allowed beside width, height or points: a nozzle is round, or has corners, or "
                   "points of its own");
  if (emitter.width.has_value() != emitter.height.has_value())
    checks.problem(emitter.width ? "emitter.height" : "emitter.width",
                   "is missing: a nozzle with corners has a width and a height");
  const double area =
      emitter.radius ? 3.15 * static_cast<double>(*emitter.radius) * static_cast<double>(*emitter.radius)
      : corners
          ? static_cast<double>(emitter.width.value_or(0)) * static_cast<double>(emitter.height.value_or(0))
          : 0;
  constexpr double k_most_points = 1e6;
  if (area > k_most_points * static_cast<double>(emitter.spacing) * static_cast<double>(emitter.spacing))
    checks.problem(
        "emitter.spacing",
        "makes layers of over a million particles; raise it, or lower radius, or width and height");
  if (emitter.start && emitter.stop && *emitter.stop <= *emitter.start) {
    std::ostringstream text;
    text << *emitter.stop << " is not allowed: after start, " << *emitter.start << " s, or it never flows";
    checks.problem("emitter.stop", text.str());
  }
  for (const Vec3& x : emitter.points)
    if (!x.allFinite()) return checks.vector("emitter.points", x);
  check_apart(emitter, checks);
}

void check(const Body& body, Checks& checks) {
  if (body.positions.empty()) checks.problem("body.positions", "has no particles: at least one is needed");
  check_value("body.spacing", body.spacing, range_of(&Sampling::spacing), checks);
  check_value("body.velocity", body.velocity, k_finite, checks);
  if (!body.velocities.empty() && body.velocities.size() != body.positions.size())
    checks.problem("body.velocities", std::to_string(body.velocities.size()) + " velocities for " +
                                          std::to_string(body.positions.size()) +
                                          " positions: none or as many");
  const auto first_bad = [&](const std::string& field, const std::vector<Vec3>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i].allFinite()) continue;
      check_value(field + '[' + std::to_string(i) + ']', values[i], k_finite, checks);
      return;
    }
  };
  first_bad("body.positions", body.positions);
  first_bad("body.velocities", body.velocities);
  const auto check_column = [&](const std::string& field, const std::vector<float>& values,
                                const Range& range) {
    if (!values.empty() && values.size() != body.positions.size())
      checks.problem(field, std::to_string(values.size()) + " numbers for " +
                                std::to_string(body.positions.size()) + " positions: none or as many");
    const auto bad = [&](float value) { return !range.holds(value) || !std::isfinite(value); };
    if (const auto first = std::ranges::find_if(values, bad); first != values.end())
      check_value(field + '[' + std::to_string(first - values.begin()) + ']', *first, range, checks);
  };
  check_column("body.alpha", body.alpha, range_of(&Material::alpha));
  check_column("body.plastic_yield", body.plastic_yield, range_of(&Material::plastic_yield));
  check_column("body.stiffness", body.stiffness, k_stiffness_factor);
  check_column("body.temperature", body.temperature, range_of(&Material::temperature));
  const auto reach = [](const Vec3& x) { return x.cwiseAbs().maxCoeff(); };
  const auto farthest = std::max_element(body.positions.begin(), body.positions.end(),
                                         [&](const Vec3& a, const Vec3& b) { return reach(a) < reach(b); });
  if (farthest == body.positions.end() || !farthest->allFinite()) return;
  if (const auto why = why_too_far(*farthest, body.spacing))
    checks.problem("body.positions[" + std::to_string(farthest - body.positions.begin()) + ']', *why);
}

}  // namespace mallow

#include "simulation/validation.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/precision.h"

namespace mallow {
namespace {

constexpr const char* k_positive = "a finite number above 0";
constexpr const char* k_not_negative = "a finite number, 0 or above";
constexpr const char* k_share = "a number in [0, 1]";

void check_optional(const char* field, const std::optional<float>& value, Checks& checks) {
  if (value) checks.number(field, *value, *value > 0, k_positive);
}

}  // namespace

void check(const SolverConfig& config, Checks& checks) {
  check_optional("solver.time_step", config.time_step, checks);
  checks.number("solver.time_step_factor", config.time_step_factor,
                config.time_step_factor >= 0.01f && config.time_step_factor <= 4, "a number in [0.01, 4]");
  checks.number("solver.support_radius", config.support_radius, config.support_radius > 0, k_positive);
  checks.vector("solver.gravity", config.gravity);
  check_optional("solver.update_period", config.update_period, checks);
  if (config.update_interval)
    checks.number("solver.update_interval", *config.update_interval, *config.update_interval >= 1,
                  "1 or above");
  if (config.update_period && config.update_interval)
    checks.problem("solver.update_interval", "is not allowed beside update_period: give one of the two");
  checks.number("solver.rotation_iterations", config.rotation_iterations,
                config.rotation_iterations >= 0 && config.rotation_iterations <= 8, "0 to 8");
  if (config.contact_offset)
    checks.number("solver.contact_offset", *config.contact_offset, *config.contact_offset >= 0,
                  k_not_negative);
  checks.number("solver.neighbor_slack", config.neighbor_slack,
                config.neighbor_slack >= 0 && config.neighbor_slack <= 1, k_share);
  checks.number("solver.threads", config.threads, config.threads >= 0 && config.threads <= 1024,
                "0 (all processors) to 1024");
  checks.number("solver.memory_limit", config.memory_limit, config.memory_limit > 0, k_positive);
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
  if (alpha.keys().empty()) checks.problem("material.alpha", "has no keys: at least one is needed");
  for (std::size_t k = 0; k < alpha.keys().size(); ++k) {
    const AlphaKey& key = alpha.keys()[k];
    checks.number("material.alpha", key.alpha, key.alpha >= 0 && key.alpha <= 1, k_share);
    checks.number("material.alpha time", key.time, k == 0 || key.time > alpha.keys()[k - 1].time,
                  "finite times, each above the one before");
  }
}

void check(const Material& material, Checks& checks) {
  check(material.alpha, checks);
  if (material.update_threshold)
    checks.number("material.update_threshold", *material.update_threshold, *material.update_threshold >= 0,
                  k_not_negative);
  if (material.pressure_coefficient)
    checks.number("material.pressure_coefficient", *material.pressure_coefficient,
                  *material.pressure_coefficient >= 0, k_not_negative);
  if (material.viscosity)
    checks.number("material.viscosity", *material.viscosity, *material.viscosity >= 0, k_not_negative);
  checks.number("material.cohesion", material.cohesion, material.cohesion >= 0 && material.cohesion <= 1,
                k_share);
  check_optional("material.elastic_time_step", material.elastic_time_step, checks);
  check_optional("material.particle_mass", material.particle_mass, checks);
  check_optional("material.rest_density", material.rest_density, checks);
  check_optional("material.region_radius", material.region_radius, checks);
  checks.number("material.region_stride", material.region_stride, material.region_stride >= 1, "1 or above");
}

void check_stiffness(const SolverConfig& config, const Material& material, Checks& checks) {
  constexpr double k_most = static_cast<double>(k_stiffest);
  constexpr double k_rounding = 1e-5;  // of what is typed with six digits
  if (material.alpha.keys().empty()) return;
  // Left out, Δt_SM is Δt0, whatever that is; given, it is judged once that is known.
  if (material.elastic_time_step && !config.time_step) return;
  const double factor = static_cast<double>(config.time_step_factor);
  const double share = (1 - static_cast<double>(material.alpha.lowest())) * factor * factor / k_most;
  std::ostringstream text;
  if (!material.elastic_time_step) {
    if (share <= 1 + k_rounding) return;
    text << config.time_step_factor << " is not allowed: (1 - alpha) time_step_factor^2 must be at most "
         << k_most << ", as elasticity would gain energy; at alpha " << material.alpha.lowest() << " at most "
         << std::sqrt(k_most / (1 - static_cast<double>(material.alpha.lowest())));
    checks.problem("solver.time_step_factor", text.str());
    return;
  }
  const double least = share * static_cast<double>(*config.time_step);
  if (static_cast<double>(*material.elastic_time_step) >= least * (1 - k_rounding)) return;
  text << *material.elastic_time_step << " is not allowed: at least (1 - alpha) "
       << (factor == 1 ? "" : "time_step_factor^2 ") << "solver.time_step/" << k_most << " = " << least
       << ", as a stiffer body would gain energy; lower solver.time_step (now " << *config.time_step << ")";
  checks.problem("material.elastic_time_step", text.str());
}

void check(const Body& body, Checks& checks) {
  if (body.positions.empty()) checks.problem("body.positions", "has no particles: at least one is needed");
  checks.number("body.spacing", body.spacing, body.spacing > 0, k_positive);
  checks.vector("body.velocity", body.velocity);
  if (!body.velocities.empty() && body.velocities.size() != body.positions.size())
    checks.problem("body.velocities", std::to_string(body.velocities.size()) + " velocities for " +
                                          std::to_string(body.positions.size()) +
                                          " positions: none or as many");
  const auto first_bad = [&](const std::string& field, const std::vector<Vec3>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i].allFinite()) continue;
      checks.vector(field + '[' + std::to_string(i) + ']', values[i]);
      return;
    }
  };
  first_bad("body.positions", body.positions);
  first_bad("body.velocities", body.velocities);
  const auto reach = [](const Vec3& x) { return x.cwiseAbs().maxCoeff(); };
  const auto farthest = std::max_element(body.positions.begin(), body.positions.end(),
                                         [&](const Vec3& a, const Vec3& b) { return reach(a) < reach(b); });
  if (farthest == body.positions.end() || !farthest->allFinite()) return;
  if (const auto why = why_too_far(*farthest, body.spacing))
    checks.problem("body.positions[" + std::to_string(farthest - body.positions.begin()) + ']', *why);
}

}  // namespace mallow

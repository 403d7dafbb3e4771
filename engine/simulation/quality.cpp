#include "mallow/quality.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/checks.h"

namespace mallow {
namespace {

void check_factor(float factor) {
  Checks checks;
  checks.number("factor", factor, factor > 0, "a finite number above 0");
  checks.finish();
}

}  // namespace

SolverConfig at_time_step(const SolverConfig& config, float factor) {
  check_factor(factor);
  SolverConfig result = config;
  result.time_step *= factor;
  const double interval = std::round(config.update_interval / static_cast<double>(factor));
  result.update_interval =
      static_cast<int>(std::clamp(interval, 1.0, static_cast<double>(std::numeric_limits<int>::max())));
  return result;
}

Material at_time_step(const Material& material, const SolverConfig& config, float factor) {
  check_factor(factor);
  Material result = material;
  result.elastic_time_step = material.elastic_time_step.value_or(config.time_step) / factor;
  return result;
}

}  // namespace mallow

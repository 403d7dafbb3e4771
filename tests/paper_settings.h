#pragma once

#include "mallow/material.h"
#include "mallow/solver_config.h"

namespace mallow {

/// The paper's numbers for what would follow from spacing and gravity: tests that count on numbers say them.
inline SolverConfig with_paper_settings(SolverConfig config) {
  if (!config.time_step) config.time_step = 0.15f;
  if (!config.update_period && !config.update_interval) config.update_interval = 60;
  if (!config.volume_iterations) config.volume_iterations = 0;
  return config;
}
inline Material with_paper_settings(Material material) {
  if (!material.update_threshold && !material.plastic_yield) material.update_threshold = 12.0f;
  if (!material.pressure_coefficient) material.pressure_coefficient = 16.0f;
  if (!material.viscosity) material.viscosity = 0.5f;
  return material;
}

}  // namespace mallow

#pragma once

#include "mallow/material.h"
#include "mallow/solver_config.h"
#include "mallow/surface_config.h"

namespace mallow {

/// The same scene at a step of `factor` (> 0) times its time_step: the elastic time step grows as the step
/// shrinks, so that the elastic pull per second, 1/(Δt0 Δt_SM), stays [TK eq. 13], and reference shapes are
/// checked after the same simulated time. Throws ConfigError where the factor is not a finite number above 0.
SolverConfig at_time_step(const SolverConfig& config, float factor);
/// config: that of the material, as it was before.
Material at_time_step(const Material& material, const SolverConfig& config, float factor);

}  // namespace mallow

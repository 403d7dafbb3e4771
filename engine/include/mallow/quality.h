#pragma once

#include <span>

#include "mallow/export.h"
#include "mallow/material.h"
#include "mallow/solver_config.h"
#include "mallow/surface_config.h"

namespace mallow {

/// The same scene in steps of `factor` (> 0) times its own: time_step_factor times that, which leaves the
/// material as it is. Throws ConfigError where the factor is not a finite number above 0.
MALLOW_EXPORT SolverConfig at_time_step(const SolverConfig& config, float factor);
/// The same surface with `factor` (> 0) times as many voxels along a length, as far as the settings' ranges
/// go. Throws ConfigError where the factor is not a finite number above 0.
MALLOW_EXPORT SurfaceConfig at_voxels(const SurfaceConfig& config, float factor);

/// How a scene's settings are turned between speed and accuracy. Each lies on or beside the fronts that
/// bench/RESULTS.md shows, with what it costs and how far off it is there.
enum class Quality {
  realtime,  ///< for games: longer steps, fewer regions, coarser surface
  balanced,  ///< what the scene says, with every second region
  accurate,  ///< for films: shorter steps, finer surface
};
/// "realtime", "balanced", "accurate".
MALLOW_EXPORT const char* name(Quality quality);
/// All there are, from fast to accurate.
MALLOW_EXPORT std::span<const Quality> qualities();

/// Longer steps are at most 1.5 times time_step, or as long as the config has them.
MALLOW_EXPORT SolverConfig with_quality(const SolverConfig& config, Quality quality);
/// config: that of the material, as it was before. A material so stiff that longer steps would make it
/// unstable is softened to where they do not, if both its elastic_time_step and the time_step are given;
/// where the time_step is left out, prepare() refuses it. A youngs_modulus is kept: steps that are left out
/// carry it at any quality, and where a time_step is given that does not, prepare() says which would.
MALLOW_EXPORT Material with_quality(const Material& material, const SolverConfig& config, Quality quality);
/// Voxels coarser or finer than the config has them.
MALLOW_EXPORT SurfaceConfig with_quality(const SurfaceConfig& config, Quality quality);

}  // namespace mallow

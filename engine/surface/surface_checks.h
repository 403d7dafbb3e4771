#pragma once

#include "mallow/surface.h"

namespace mallow {

/// These throw ConfigError with all that is not as mallow/surface.h says.
void check(const SurfaceConfig& config, int threads);
void check(const SurfaceParticles& particles);

}  // namespace mallow

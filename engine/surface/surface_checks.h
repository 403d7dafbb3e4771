#pragma once

#include <string>

#include "core/checks.h"
#include "mallow/surface.h"

namespace mallow {

/// These throw ConfigError with all that is not as mallow/surface.h says.
void check(const SurfaceConfig& config, int threads);
void check(const SurfaceParticles& particles);

/// "positions[3]".
std::string element(const char* column, std::size_t index);
/// The first vector that is not finite is a problem.
void check_finite(const char* column, const StridedVectors& vectors, Checks& checks);

}  // namespace mallow

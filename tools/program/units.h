#pragma once

#include "mallow/solver_config.h"

namespace mallow::program {

/// Whether units are a scene's own, as no planet or moon has such gravity in m/s²: no unit of SI is printed
/// then.
bool has_own_units(const SolverConfig& config);

}  // namespace mallow::program

#include "program/units.h"

#include "simulation/settings.h"

namespace mallow::program {

bool has_own_units(const SolverConfig& config) {
  return has_free_units(config.gravity);
}

}  // namespace mallow::program

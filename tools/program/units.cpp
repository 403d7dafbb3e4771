#include "program/units.h"

#include "config/gravity_units.h"

namespace mallow::program {

bool has_own_units(const SolverConfig& config) {
  return has_free_units(config.gravity);
}

}  // namespace mallow::program

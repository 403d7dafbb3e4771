#include "mallow/files.h"
#include "mallow/simulation.h"

// Apart from the files, whose readers thereby need no simulation to be linked, as the fuzz targets do.
namespace mallow {

ParticleFrame snapshot(const Simulation& simulation) {
  return {simulation.positions_by_id(), simulation.velocities_by_id(), simulation.groups_by_id(),
          simulation.time(), simulation.step_count()};
}

}  // namespace mallow

#include "mallow/files.h"
#include "mallow/simulation.h"

// Apart from the files, whose readers thereby need no simulation to be linked, as the fuzz targets do.
namespace mallow {

ParticleFrame snapshot(const Simulation& simulation) {
  const std::vector<std::uint32_t> bodies = simulation.bodies_by_id();
  if (simulation.body_count() > 256)
    throw ConfigError("frame.groups", "at most 256 bodies are possible in a frame");
  return {simulation.positions_by_id(), simulation.velocities_by_id(),
          std::vector<std::uint8_t>(bodies.begin(), bodies.end()), simulation.time(),
          simulation.step_count()};
}

}  // namespace mallow

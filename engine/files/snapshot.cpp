#include "mallow/errors.h"
#include "mallow/files.h"
#include "mallow/simulation.h"
#include "mallow/surface.h"

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

SurfaceParticles surface_particles(const ParticleFrame& frame, std::span<const float> spacings) {
  SurfaceParticles particles{.positions = frame.positions, .velocities = frame.velocities, .bodies = {}};
  for (std::size_t begin = 0, end = 0; begin < frame.groups.size(); begin = end) {
    const std::uint8_t group = frame.groups[begin];
    if (group >= spacings.size())
      throw ConfigError("groups[" + std::to_string(begin) + "]",
                        std::to_string(group) + " is not allowed: below the number of spacings, " +
                            std::to_string(spacings.size()));
    while (end < frame.groups.size() && frame.groups[end] == group) ++end;
    particles.bodies.push_back(
        {.spacing = spacings[group], .group = group, .rows = Simulation::Rows{begin, end}});
  }
  return particles;
}

}  // namespace mallow

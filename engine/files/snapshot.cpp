#include <algorithm>

#include "mallow/errors.h"
#include "mallow/files.h"
#include "mallow/simulation.h"
#include "mallow/surface.h"

// Apart from the files, whose readers thereby need no simulation to be linked, as the fuzz targets do.
namespace mallow {

namespace {

/// Of a column by row, in the order of slots.
std::vector<float> by_id(const Simulation& simulation, std::span<const float> column) {
  std::vector<float> values;
  if (column.empty()) return values;
  std::vector<ParticleId> ids(simulation.ids().begin(), simulation.ids().end());
  std::ranges::sort(ids, {}, [](ParticleId id) { return slot_of(id); });
  for (const ParticleId id : ids) values.push_back(column[simulation.row(id)]);
  return values;
}

}  // namespace

ParticleFrame snapshot(const Simulation& simulation) {
  ParticleFrame frame{simulation.positions_by_id(), simulation.velocities_by_id(), simulation.bodies_by_id(),
                      simulation.time(), simulation.step_count()};
  frame.alphas = by_id(simulation, simulation.alphas());
  frame.temperatures = by_id(simulation, simulation.temperatures());
  const std::span<const ParticleId> ids = simulation.ids();
  // As long as nobody was removed they are the numbers below that of all particles.
  if (std::ranges::all_of(ids, [&](ParticleId id) { return id < ids.size(); })) return frame;
  frame.ids.assign(ids.begin(), ids.end());
  std::ranges::sort(frame.ids, {}, [](ParticleId id) { return slot_of(id); });
  return frame;
}

SurfaceParticles surface_particles(const ParticleFrame& frame, std::span<const float> spacings) {
  SurfaceParticles particles{.positions = frame.positions, .velocities = frame.velocities, .bodies = {}};
  for (std::size_t begin = 0, end = 0; begin < frame.bodies.size(); begin = end) {
    const std::uint32_t body = frame.bodies[begin];
    if (body >= spacings.size())
      throw ConfigError("frame.bodies[" + std::to_string(begin) + "]",
                        std::to_string(body) + " is not allowed: below the number of spacings, " +
                            std::to_string(spacings.size()));
    while (end < frame.bodies.size() && frame.bodies[end] == body) ++end;
    particles.bodies.push_back(
        {.spacing = spacings[body], .body = body, .rows = Simulation::Rows{begin, end}});
  }
  return particles;
}

}  // namespace mallow

#include "mallow/surface.h"

namespace mallow {

SurfaceParticles surface_particles(const Simulation& simulation) {
  SurfaceParticles particles{.positions = simulation.positions(),
                             .velocities = simulation.velocities(),
                             .bodies = {},
                             .ids = simulation.ids()};
  for (const BodyId body : simulation.bodies())
    particles.bodies.push_back({.spacing = simulation.spacing(body),
                                .body = slot_of(body),
                                .rows = simulation.rows(body),
                                .name = simulation.name(body),
                                .material = simulation.material(body)});
  return particles;
}

}  // namespace mallow

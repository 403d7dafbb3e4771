#include "mallow/surface.h"

namespace mallow {

SurfaceParticles surface_particles(const Simulation& simulation) {
  SurfaceParticles particles{.positions = simulation.positions(),
                             .velocities = simulation.velocities(),
                             .bodies = {},
                             .ids = simulation.ids()};
  for (std::size_t b = 0; b < simulation.body_count(); ++b) {
    const auto number = static_cast<std::uint32_t>(b);
    const BodyId body{number};
    particles.bodies.push_back(
        {.spacing = simulation.spacing(body), .body = number, .rows = simulation.rows(body)});
  }
  return particles;
}

}  // namespace mallow

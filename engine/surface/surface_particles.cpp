#include "mallow/surface.h"

namespace mallow {

SurfaceParticles surface_particles(const Simulation& simulation) {
  SurfaceParticles particles{.positions = simulation.positions(),
                             .velocities = simulation.velocities(),
                             .bodies = {},
                             .ids = simulation.ids()};
  if (simulation.body_count() > 256) throw ConfigError("bodies", "at most 256 can be drawn");
  for (std::size_t b = 0; b < simulation.body_count(); ++b) {
    const BodyId body{static_cast<std::uint32_t>(b)};
    particles.bodies.push_back({.spacing = simulation.spacing(body),
                                .group = static_cast<std::uint8_t>(b),
                                .rows = simulation.rows(body)});
  }
  return particles;
}

}  // namespace mallow

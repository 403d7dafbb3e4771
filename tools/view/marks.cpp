#include "view/marks.h"

#include <algorithm>

#include "view/verbs.h"

namespace mallow::view {
namespace {

std::optional<BodyId> body_at(const Simulation& simulation, std::size_t row) {
  for (const BodyId body : simulation.bodies()) {
    const Simulation::Rows rows = simulation.rows(body);
    if (row >= rows.begin && row < rows.end) return body;
  }
  return std::nullopt;
}

/// Bodies are in the order of those of SimulationInfo.
float region_radius(const Simulation& simulation, BodyId body) {
  const std::vector<BodyId> bodies = simulation.bodies();
  const auto place = std::ranges::find(bodies, body) - bodies.begin();
  return simulation.info().bodies[static_cast<std::size_t>(place)].region_radius;
}

void place_region(const Simulation& simulation, ParticleId chosen, PlacedMarks& marks) {
  const auto row = row_of(simulation, chosen);
  if (!row) return;
  const VectorView positions = simulation.positions();
  marks.chosen = positions[*row];
  const auto body = body_at(simulation, *row);
  if (!body) return;
  try {
    const std::size_t begin = simulation.rows(*body).begin;
    const VectorView rest = simulation.rest_positions(*body);
    const float radius = region_radius(simulation, *body);
    const Vec3 middle = rest[*row - begin];
    for (std::size_t k = 0; k < rest.size(); ++k)
      if (begin + k != *row && (rest[k] - middle).norm() <= radius)
        marks.region.push_back(positions[begin + k]);
  } catch (const ConfigError&) {
    // A fluid keeps no reference shape, and has no regions.
  }
}

}  // namespace

std::vector<ParticleId> pinned_by(const Scene& scene, const Simulation& simulation) {
  std::vector<ParticleId> pinned;
  for (const ScenePin& pin : scene.pins) {
    const std::vector<ParticleId> ids = simulation.particles_in(pin.box);
    pinned.insert(pinned.end(), ids.begin(), ids.end());
  }
  return pinned;
}

PlacedMarks place(const Marks& asked, const Simulation& simulation, const std::vector<ParticleId>& pinned,
                  const std::optional<ParticleId>& chosen, double last_step) {
  PlacedMarks marks;
  if (asked.pins)
    for (const ParticleId id : pinned)
      if (const auto row = row_of(simulation, id)) marks.pins.push_back(simulation.positions()[*row]);
  if (asked.region && chosen) place_region(simulation, *chosen, marks);
  if (asked.contacts && last_step > 0)
    for (const BodyEvent& event : simulation.events())
      if (event.kind == BodyEvent::Kind::hit)
        marks.contacts.push_back({event.position, event.impulse / static_cast<float>(last_step)});
  return marks;
}

}  // namespace mallow::view

// What sleeps still weighs on what it lies on.
#include <algorithm>

#include "simulation/phases.h"
#include "simulation/state.h"

namespace mallow {
namespace {

/// share: of `load` [1/s].
void keep(const Simulation::State& s, std::size_t collider, const ColliderLoad& load, double share,
          BodyState& body) {
  if (load.impulse.isZero(0) && load.torque.isZero(0)) return;
  const std::uint64_t id = s.collider_ids[collider];
  auto kept = std::ranges::find(body.resting, id, &BodyState::RestingLoad::collider);
  if (kept == body.resting.end()) kept = body.resting.insert(kept, {.collider = id, .load = {}});
  kept->load.impulse += share * load.impulse;
  kept->load.torque += share * load.torque;
}

}  // namespace

void keep_loads(Simulation::State& s, double time_step) {
  const MovingBodies& moving = s.moving;
  const std::size_t colliders = moving.loads.size();
  if (colliders == 0) return;
  for (std::size_t b = 0; b < moving.partial.size(); ++b) {
    BodyState& body = *s.awake[moving.blocks.blocks[b].range];
    for (std::size_t c = 0; c < colliders && body.island != 0; ++c)
      keep(s, c, moving.partial_loads[b * colliders + c], static_cast<double>(body.mass) / time_step, body);
  }
  const Walls& walls = s.sph.walls;
  if (!s.walls() || walls.loads.empty()) return;
  for (std::size_t k = 0; k < walls.partial_loads.size(); ++k) {
    BodyState& body = s.body_of(walls.bodies[walls.blocks.blocks[k / colliders].range].begin);
    if (body.island != 0) keep(s, k % colliders, walls.partial_loads[k], 1, body);
  }
}

void add_resting_loads(Simulation::State& s, double time_step) {
  if (s.moving.loads.empty()) return;
  for (const BodyState& body : s.bodies)
    for (const BodyState::RestingLoad& resting : body.resting) {
      const std::optional<std::size_t> at = s.collider_slots.find(resting.collider);
      if (!at) continue;
      s.moving.loads[*at].impulse += time_step * resting.load.impulse;
      s.moving.loads[*at].torque += time_step * resting.load.torque;
    }
}

}  // namespace mallow

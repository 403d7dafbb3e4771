// What colliders hold of the volume around fluids, and what that pushes. [model 2, section 2]
#include <algorithm>

#include "colliders/pose.h"
#include "core/parallel.h"
#include "simulation/phases.h"
#include "simulation/state.h"
#include "sph/held_walls.h"

namespace mallow {

void find_walls(Simulation::State& state) {
  Walls& walls = state.sph.walls;
  walls.bodies.clear();
  if (state.config.wall_pressure && state.config.formulation == Formulation::conservative &&
      !state.colliders.empty()) {
    for (const BodyState* moving : state.awake) {
      const BodyState& body = *moving;
      if (!(body.most_alpha() > 0)) continue;
      walls.bodies.push_back(
          {.begin = body.begin,
           .end = body.end,
           .reach = state.support_radius() + state.contact_offset(body) - 0.5f * body.spacing,
           .alpha = body.material->alpha,
           .mass = body.mass,
           .group = &state.sph.groups[body.sph_group]});
    }
  }
  if (walls.bodies.empty()) {
    walls.release();
    return;
  }
  // Where they stand is all that is read of them: the velocities of this step are not known yet.
  place_colliders(state.colliders, state.origin, state.base_step(), state.execution.level,
                  state.placed_colliders);
  find_walls(state.store.position, state.store.velocity, state.placed_colliders, state.sph.kernel,
             state.support_radius(), state.execution, walls);
}

void press_walls(Simulation::State& state) {
  Sph& sph = state.sph;
  if (sph.walls.bodies.empty()) return;
  const ParticleStore& store = state.store;
  press_walls({.position = store.position,
               .density = sph.density_by_row,
               .sph_acceleration = sph.acceleration,
               .gravity = state.config.gravity,
               .alpha = state.is_painted() ? store.alpha.data() : nullptr,
               .pin = store.pin.empty() ? nullptr : store.pin.data(),
               .all_loads = state.reports_contacts()},
              state.placed_colliders, state.execution, sph.walls);
}

void add_wall_loads(Simulation::State& state, const std::vector<ColliderLoad>& given, float time_step) {
  Walls& walls = state.sph.walls;
  for (std::size_t k = 0; k < given.size(); ++k) {
    walls.partial_loads[k].impulse += given[k].impulse / static_cast<double>(time_step);
    walls.partial_loads[k].torque += given[k].torque / static_cast<double>(time_step);
    if (state.moving.loads.empty()) continue;
    state.moving.loads[k % walls.loads.size()].impulse += given[k].impulse;
    state.moving.loads[k % walls.loads.size()].torque += given[k].torque;
  }
}

namespace {

/// What sticks does not slip along colliders; of the others friction takes its share later.
void hold_what_sticks(Simulation::State& state, float time_step) {
  ParticleStore& store = state.store;
  Walls& walls = state.sph.walls;
  const auto sticks = [&](const BodyState* body) { return state.sticks_to_walls(*body); };
  if (std::ranges::none_of(state.awake, sticks)) return;
  walls.rubbed.assign(walls.partial_loads.size(), {});
  const HoldInput in{.position = store.position,
                     .pin = store.pin.empty() ? nullptr : store.pin.data(),
                     .viscosity = state.viscosity.empty() ? nullptr : state.viscosity.data(),
                     .alpha = state.is_painted() ? store.alpha.data() : nullptr,
                     .time_step = time_step};
  std::size_t number = 0;
  for (const BodyState* body : state.awake) {
    if (!(body->most_alpha() > 0)) continue;  // as find_walls() counts them
    const std::size_t place = number++;
    if (!sticks(body)) continue;
    hold_at_walls(in,
                  {.number = place,
                   .spacing = body->spacing,
                   .inward = 0.5f * body->spacing - state.contact_offset(*body),
                   .viscosity = body->viscosity,
                   .adhesion = body->material->settings.adhesion,
                   .mass = body->mass},
                  state.placed_colliders, state.execution, walls, store.next_velocity);
  }
  add_wall_loads(state, walls.rubbed, time_step);
}

}  // namespace

void rub_walls(Simulation::State& state, float time_step) {
  ParticleStore& store = state.store;
  hold_what_sticks(state, time_step);
  rub_walls({.position = store.position,
             .before = store.velocity,
             .pin = store.pin.empty() ? nullptr : store.pin.data(),
             .time_step = time_step},
            state.placed_colliders, state.execution, state.sph.walls, store.next_velocity);
  add_wall_loads(state, state.sph.walls.rubbed, time_step);
}

}  // namespace mallow

// Between v' and contact: what keeps densities from rising above those at rest.
#include <algorithm>

#include "core/parallel.h"
#include "simulation/state.h"

namespace mallow {
namespace {

/// What contact would make of v', which stays: what is pressed against a floor is pressed together only where
/// the floor is known of. Without, bodies at rest stayed a quarter too dense.
const VectorColumn& find_contacted(Simulation::State& state, float time_step) {
  const VectorColumn& predicted = state.store.next_velocity;
  const bool collides = !state.placed_colliders.empty();
  if (!collides && !state.bodies_touch()) return predicted;
  VectorColumn& contacted = state.volume.contacted;
  contacted.resize_unset(predicted.size());
  parallel_for(state.execution.threads, predicted.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = 0; a < 3; ++a)
      std::copy(predicted.axis(a) + begin, predicted.axis(a) + end, contacted.axis(a) + begin);
  });
  if (state.bodies_touch()) touch_bodies(state, time_step, false, contacted);
  if (collides) preview_contact(state.execution, state.store, state.moving, contacted);
  return contacted;
}

/// What walls got goes where their pressure went.
void add_wall_loads(Simulation::State& state, double time_step) {
  const std::vector<ColliderLoad>& given = state.volume.wall_loads;
  Walls& walls = state.sph.walls;
  for (std::size_t k = 0; k < given.size(); ++k) {
    walls.partial_loads[k].impulse += given[k].impulse / time_step;
    walls.partial_loads[k].torque += given[k].torque / time_step;
    if (state.moving.loads.empty()) continue;
    state.moving.loads[k % walls.loads.size()].impulse += given[k].impulse;
    state.moving.loads[k % walls.loads.size()].torque += given[k].torque;
  }
}

}  // namespace

void correct_volume(Simulation::State& state, float time_step, StepReport& report) {
  const VolumeStep step{.position = state.store.position,
                        .pin = state.store.pin.empty() ? nullptr : state.store.pin.data(),
                        .colliders = state.placed_colliders,
                        .time_step = time_step};
  const double tolerance = static_cast<double>(state.config.volume_tolerance);
  begin_volume(step, state.sph, state.execution, state.volume);
  for (int& taken = report.volume_iterations;; ++taken) {
    const VectorColumn& contacted = find_contacted(state, time_step);
    const Compression found =
        find_compression(step, contacted, taken == 0, state.sph, state.execution, state.volume);
    report.mean_compression = found.mean;
    report.largest_compression = found.largest;
    if (found.largest == 0 || (tolerance > 0 && found.mean <= tolerance)) break;
    if (taken == state.config.volume_iterations) break;
    correct_velocities(step, state.sph, state.execution, state.volume, state.store.next_velocity);
    if (tolerance == 0 && taken + 1 == state.config.volume_iterations) {
      ++taken;
      break;
    }
  }
  add_wall_loads(state, static_cast<double>(time_step));
  remember_predicted(state.execution, state.store, state.moving);
}

}  // namespace mallow

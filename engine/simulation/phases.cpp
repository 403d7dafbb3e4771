#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

#include "colliders/pose.h"
#include "core/parallel.h"
#include "shape_matching/reshape.h"
#include "simulation/damage.h"
#include "simulation/membership.h"
#include "simulation/phases.h"
#include "simulation/settings.h"
#include "simulation/state.h"

namespace mallow {
namespace {

/// Steps between sorts of the rows of fluids. A sort takes a third of a step; a million particles whose rows
/// are in no order take half as long again for every step.
constexpr std::int64_t k_sort_interval = 60;

/// Way of a particle in one step, in spacings, that iterations of the volume constraint may add before those
/// that may touch are looked for again: several times what gravity adds, and few more pairs to try.
constexpr float k_contact_slack = 0.05f;
/// How far apart two particles may be that touch in a step, in support radii. Each moves by one less half a
/// spacing (step_length.cpp), so 2.06 are enough; more only if what they are thrown by is no number.
constexpr float k_farthest_pair = 2.5f;

}  // namespace

bool Simulation::State::needs_sph() const {
  const bool presses = bodies.size() > 1 && !sph.apart;
  return std::ranges::any_of(bodies, [&](const BodyState& body) {
    return body.moves() && (presses || body.is_heated || body.most_alpha() > 0);
  });
}

void read_alphas(Simulation::State& state) {
  for (MaterialState& material : state.materials) {
    const float before = std::exchange(material.alpha, material.settings.alpha.at(state.time));
    if (material.alpha == before) continue;
    state.blend_changed = true;
    for (BodyState& body : state.bodies)
      if (body.material == &material) wake_island(state, body);
  }
  follow_temperatures(state);
  blend_bodies(state);
  resolve_pressures(state);
}

void sort_fluids(Simulation::State& state) {
  const CellGrid& grid = state.sph.grid;
  if (state.step % k_sort_interval != 1 || grid.order.empty()) return;
  const auto sorts = [](const BodyState& body) { return !body.keeps_reference() && body.moves(); };
  if (std::ranges::none_of(state.bodies, sorts)) return;
  // From the first row of each body on: its rows within the body, in the order of the grid.
  std::vector<std::uint32_t>& filled = state.fluid_rows;
  filled.assign(state.bodies.size(), 0);
  state.fluid_order.resize_unset(state.store.size());
  for (const std::uint32_t row : grid.order) {
    const BodyState& body = std::as_const(state).body_of(row);
    std::uint32_t& next = filled[state.place_of(body)];
    state.fluid_order[body.begin + next++] = row - static_cast<std::uint32_t>(body.begin);
  }
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const BodyState& body = state.bodies[b];
    if (sorts(body) && body.size() > 1 && filled[b] == body.size())  // none is in it of one that slept
      state.store.permute(body.begin, state.fluid_order.span().subspan(body.begin, body.size()),
                          state.execution.threads);
  }
  state.rows_moved();
}

void call_force(Simulation::State& state) {
  if (!state.force) return;
  VectorColumn& a = state.user_acceleration;
  const std::size_t n = state.store.size();
  a.resize(n);
  for (std::size_t axis = 0; axis < 3; ++axis) std::fill_n(a.axis(axis), n, 0.0f);
  const VectorColumn &x = state.seen_positions(), &v = state.store.velocity;
  struct Calling {
    bool& flag;
    explicit Calling(bool& f) : flag(f) { flag = true; }
    ~Calling() { flag = false; }
  };
  {
    const Calling calling(state.in_force_callback);
    state.force({state.time, state.store.id.span(), {x.x(), n, x.stride()}, {v.x(), n, v.stride()}},
                {a.x(), n, a.stride()});
  }
  if (!state.bodies_sleep()) return;
  // What a force acts on does not sleep, or wakes for the next step.
  for (BodyState& body : state.bodies) {
    const auto acts = [&](std::size_t axis) {
      return std::any_of(a.axis(axis) + body.begin, a.axis(axis) + body.end,
                         [](float value) { return value != 0; });
    };
    if (body.enabled && (acts(0) || acts(1) || acts(2))) wake_island(state, body);
  }
}

const VectorColumn& lead_positions(Simulation::State& state) {
  const ParticleStore& store = state.store;
  const auto damped = [&](const BodyState& body) {
    return body.matches_shape() && body.material->settings.damping_time > 0;
  };
  if (std::ranges::none_of(state.awake, [&](const BodyState* body) { return damped(*body); }))
    return store.position;
  state.led_position.resize_unset(store.size());
  state.led_blocks.clear();
  for (const BodyState* body : state.awake) state.led_blocks.add(body->size());
  parallel_for(state.execution.threads, state.led_blocks, [&](const RangeBlocks::Block& block, std::size_t) {
    const BodyState& body = *state.awake[block.range];
    const float lead = damped(body) ? body.material->settings.damping_time : 0.0f;
    for (std::size_t a = 0; a < 3; ++a) {
      const float *x = store.position.axis(a) + body.begin, *v = store.velocity.axis(a) + body.begin;
      float* const to = state.led_position.axis(a) + body.begin;
      for (std::size_t i = block.begin; i < block.end; ++i) to[i] = x[i] + lead * v[i];
    }
  });
  return state.led_position;
}

namespace {

/// Friction does not act on it: all of it is a fluid that walls hold by its viscosity.
bool slips(const Simulation::State& state, const BodyState& body) {
  return state.sticks_to_walls(body) && !body.keeps_reference();
}

/// What moves a body in a step; its pull acts for pull_time [s].
MotionInput motion_of(Simulation::State& state, const BodyState& body, float time_step, float pull_time) {
  const SolverConfig& config = state.config;
  return {
      .begin = body.begin,
      .end = body.end,
      .time_step = time_step,
      // Where particles differ, a^SPH and the pull are blended already.
      .alpha = state.is_painted() ? 1.0f : body.material->alpha,
      .elastic_factor = pull_time * state.stiffness(body),
      .gravity = config.gravity,
      .sph_acceleration = state.sph_ran && (state.is_painted() || body.material->alpha > 0)
                              ? &state.sph.acceleration
                              : nullptr,
      .cross_group = state.cross_group(),
      .walls = state.walls(),
      .user = state.user(),
      .pull = body.matches_shape() ? &body.shape.pull : nullptr,
      .colliders = slips(state, body) ? state.slippery_colliders : state.placed_colliders,
      .contact = {.time_step = time_step,
                  .max_push = state.support_radius() / (10.0f * state.base_step()),
                  .contact_offset = state.contact_offset(body),
                  .gravity = {config.gravity[0], config.gravity[1], config.gravity[2]},
                  .least_bounce = 2.0f * config.gravity.norm() * time_step},
      .pins = state.pin_motions,
      .measure_external = body.measures_external,
      .measure_rigid = body.keeps_reference() && state.deformation_damping(body) > 0,
      .measure_speed = state.bodies_sleep(),
      .sum_touches = body.hit_impulse.has_value(),
      .damping = body.matches_shape() ? -std::expm1(-state.deformation_damping(body) * time_step) : 0.0f,
      .rigid = body.rigid,
      .mass = body.mass,
  };
}

/// What takes it where it is told to be, in the time that it was given.
Vec3 velocity_of(const PinState& pin, float time_step) {
  if (pin.seconds == 0) return pin.velocity;
  return pin.left / std::max(static_cast<float>(pin.seconds), time_step);
}

void move_pins(Simulation::State& state, double time_step) {
  for (std::size_t p = 0; p < state.pins.size(); ++p) {
    PinState& pin = state.pins[p];
    if (pin.seconds == 0) continue;
    pin.left -= static_cast<float>(time_step) * state.pin_motions[p].velocity;
    pin.seconds = std::max(0.0, pin.seconds - time_step);
    if (pin.seconds == 0) pin.velocity = Vec3(0, 0, 0);
  }
}

void plan_motion(Simulation::State& state, float time_step) {
  const bool judged = is_judged(state);
  // Velocities go from the middle of the last step to the middle of this one: with the whole of this one in
  // its place, steps that a limit varies feed a stiff body. The two are the same where steps are equal.
  const auto last_step = static_cast<float>(state.last_time_step);
  const float pull_time = last_step > 0 ? 0.5f * (last_step + time_step) : time_step;
  drive_colliders(state.time + static_cast<double>(time_step), static_cast<double>(time_step),
                  state.colliders);
  place_colliders(state.colliders, state.origin, time_step, state.execution.level, state.placed_colliders);
  if (std::ranges::any_of(state.awake, [&](const BodyState* body) { return slips(state, *body); })) {
    state.slippery_colliders = state.placed_colliders;
    for (PlacedCollider& collider : state.slippery_colliders) collider.surface.friction = 0;
  }
  state.moving.loads.assign(any_measures_load(state.placed_colliders) ? state.colliders.size() : 0, {});
  if (state.walls()) {
    for (std::size_t c = 0; c < state.moving.loads.size(); ++c) {
      const ColliderLoad& load = state.sph.walls.loads[c];
      state.moving.loads[c].impulse = static_cast<double>(time_step) * load.impulse;
      state.moving.loads[c].torque = static_cast<double>(time_step) * load.torque;
    }
  }
  add_resting_loads(state, static_cast<double>(time_step));
  state.pin_motions.clear();
  for (const PinState& pin : state.pins)
    state.pin_motions.push_back({.velocity = velocity_of(pin, time_step)});
  drive_emitters(state, state.time + static_cast<double>(time_step), static_cast<double>(time_step));
  state.moving.inputs.clear();
  for (BodyState* body : state.awake) {
    body->measures_external = judged && body->follows_threshold();
    state.moving.inputs.push_back(motion_of(state, *body, time_step, pull_time));
  }
}

void judge_motion(Simulation::State& state) {
  for (const MotionSums& sums : state.moving.sums)
    if (sums.bad_row != SIZE_MAX)
      refuse_damage(state, Phase::motion, static_cast<std::uint32_t>(sums.bad_row));
  for (std::size_t b = 0; b < state.awake.size(); ++b) {
    BodyState& body = *state.awake[b];
    const MotionSums& sums = state.moving.sums[b];
    body.mean_speed = sums.speed / static_cast<double>(body.size());
    body.step_external = sums.unpinned > 0 ? sums.external / static_cast<double>(sums.unpinned) : 0.0;
  }
  constexpr std::size_t k_bodies = 16;  // one takes a fraction of a microsecond, most of all a flat one
  parallel_for(
      state.execution.threads, state.awake.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
          RigidMotion& rigid = state.awake[b]->rigid;
          if (state.moving.inputs[b].measure_rigid)
            rigid = rigid_motion(state.moving.sums[b].rigid, rigid.center);
        }
      },
      k_bodies);
}

}  // namespace

void move_bodies(Simulation::State& state, float time_step, const MotionPhases& phases) {
  if (phases.predict) plan_motion(state, time_step);
  move_particles(phases, state.execution, state.store, state.moving);
  if (phases.advance) judge_motion(state);
}

namespace {

/// Bodies that slept until something pushed them move on with the others. They were at rest, where all that
/// acts on a particle cancels: v' is what they got.
void wake_pushed(Simulation::State& state, float time_step) {
  const ContactPairs& pairs = state.contact_pairs;
  if (pairs.points.empty()) return;
  std::vector<std::uint32_t> pushed;
  for (std::size_t k = 0; k < pairs.blocks.size(); ++k) {
    const std::uint32_t body = pairs.near.blocks.blocks[k].range;
    if (state.bodies[body].island == 0 || (!pushed.empty() && pushed.back() == body)) continue;
    std::uint32_t point = pairs.points.first[k];
    const std::uint32_t end = pairs.points.first[k + 1];
    while (point < end && pairs.points.velocity_of(point).isZero(0)) ++point;
    if (point < end) pushed.push_back(body);
  }
  for (const std::uint32_t body : pushed) {
    wake_island(state, state.bodies[body]);
    state.awake.push_back(&state.bodies[body]);
    join_motion(motion_of(state, state.bodies[body], time_step, 0), state.moving);
  }
  state.events.insert(state.events.end(), state.next_events.begin(), state.next_events.end());
  state.next_events.clear();
}

}  // namespace

void touch_bodies(Simulation::State& state, float time_step, const ContactCall& call,
                  VectorColumn& velocities) {
  state.touching.clear();
  for (const BodyState& body : state.bodies)
    state.touching.push_back({.begin = body.begin,
                              .end = body.enabled ? body.end : body.begin,
                              .group = body.sph_group,
                              .spacing = body.spacing,
                              .mass = body.mass,
                              .friction = body.material->settings.friction,
                              .adhesion = body.material->settings.adhesion,
                              .sleeps = body.island != 0,
                              .shape = body.matches_shape() ? &body.shape : nullptr});
  const ParticleStore& store = state.store;
  state.contact_pairs.keeps_sums = call.keeps_sums;
  const float spacing = std::ranges::min(state.touching, {}, &TouchingBody::spacing).spacing;
  resolve_body_contacts(store.position, store.pin.empty() ? nullptr : store.pin.data(), state.touching,
                        {.time_step = time_step,
                         .reach = k_farthest_pair * state.support_radius(),
                         .max_push = state.support_radius() / (10.0f * state.base_step()),
                         .again = call.again,
                         .slack = state.keeps_volume() ? k_contact_slack * spacing / time_step : 0.0f},
                        state.execution, velocities, state.contact_pairs);
}

void resolve_touching(Simulation::State& state, float time_step) {
  touch_bodies(state, time_step, {.again = state.keeps_volume(), .keeps_sums = state.reports_contacts()},
               state.store.next_velocity);
  wake_pushed(state, time_step);
}

void finish_step(Simulation::State& state, const ChosenStep& step) {
  state.store.position.swap(state.store.next_position);
  state.store.velocity.swap(state.store.next_velocity);
  move_colliders(step.end, static_cast<double>(step.time_step), state.colliders);
  move_pins(state, static_cast<double>(step.time_step));
  move_emitters(state, step.end, static_cast<double>(step.time_step));
  add_external(state, static_cast<double>(step.time_step));
  state.time = step.end;
  state.last_time_step = static_cast<double>(step.time_step);
  ++state.step;
}

}  // namespace mallow

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

void take_reference(Simulation::State& state, BodyState& body) {
  PillarOrder& pillars = state.region_scratch.pillars;
  body.shape.spacing = body.spacing;
  update_reference(state.store.position, body.begin, body.end, state.execution.threads, state.region_scratch,
                   body.shape);
  sort_reference(state.execution, pillars, body.shape);
  state.store.permute(body.begin, pillars.order.span(), state.execution.threads);
  state.rows_moved();
  state.held = false;
}

/// Velocities are those of half a step ago. What the old shape pulled since then goes into them before it is
/// gone: then an update takes energy and never gives any. Without, a body that yields every few steps and is
/// as stiff as its step gained energy at each update that met it swinging back.
void kick_by_pull(Simulation::State& state, BodyState& body, float share) {
  MatchedBodies matched;
  weigh_regions(state.execution.threads, state.store, body);
  matched.add(body.shape, body.begin);
  match_shapes(state.store.position, state.config.rotation_iterations, state.execution, matched);
  const float kick = share * static_cast<float>(state.last_time_step) * state.stiffness(body);
  ParticleStore& store = state.store;
  parallel_for(state.execution.threads, body.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t row = body.begin + i;
      if (!store.pin.empty() && store.pin[row] != 0) continue;
      store.velocity.set(row, store.velocity.get(row) + kick * body.shape.pull.get(i));
    }
  });
}

void take_frame(Simulation::State& state, BodyState& body, CarriedRegions& carried) {
  take_reference(state, body);
  const std::span<const std::uint32_t> order = state.region_scratch.pillars.order.span();
  sort_parts(order, state.parts_before);
  sort_carried(order, carried);
  build_carried(carried, state.execution, state.region_scratch, body.shape);
}

namespace {

FlowRule flow_rule(const Material& material) {
  return {.yield = material.plastic_yield.value_or(0.0f),
          .creep = material.plastic_creep.value_or(std::numeric_limits<float>::infinity())};
}

bool frame_is_due(Simulation::State& state, const BodyState& body) {
  const Material& material = body.material->settings;
  return reframe_is_due(state.store.position, body.begin, {material.merge_flow, material.tear_strain},
                        state.execution, body.shape, state.region_scratch.flow);
}

/// What the regions of a body take along into a new frame, where it gets one now: at a check where one is due
/// and no blow strains it, or where it has flowed too far to wait.
std::optional<CarriedRegions> new_frame(Simulation::State& state, BodyState& body, bool check) {
  if (!body.flows()) return {};
  const bool far = has_flowed_too_far(body.shape);
  if (!far && !(check && frame_is_due(state, body))) return {};
  check_damage(state);
  ReframedShape found =
      reframe_regions(state.store.position, body.begin, flow_rule(body.material->settings).yield,
                      state.config.rotation_iterations, state.execution, body.shape);
  if (!far && found.is_strained) return {};
  return std::move(found.carried);
}

/// What became of the parts of a body, whose regions are built anew.
void tell_parts(Simulation::State& state, const BodyState& body) {
  Parts &before = state.parts_before, &after = state.parts_after;
  const auto tell = [&](BodyEvent::Kind kind) {
    state.events.push_back({.kind = kind, .body = body.id, .parts = after.count});
  };
  if (any_in_two(before, after)) tell(BodyEvent::Kind::torn);
  if (any_in_two(after, before)) tell(BodyEvent::Kind::merged);
}

/// Whether a body that has yielded is still in one part: then it comes to rest as one. Nobody has followed
/// its rigid motion while it was not.
void judge_parts(Simulation::State& state, BodyState& body, bool was_apart) {
  body.apart = state.parts_after.count != 1;
  if (was_apart && !body.apart) measure_rigid(state, body);
}

}  // namespace

int update_references(Simulation::State& state) {
  int updated = 0;
  const bool check = update_is_due(state);
  for (BodyState* moving : state.awake) {
    BodyState& body = *moving;
    const double threshold =
        static_cast<double>(body.material->update_threshold * (1.0f - body.most_alpha()));
    const bool yields = check && body.follows_threshold() && body.judged_external > threshold;
    std::optional<CarriedRegions> frame = yields ? std::nullopt : new_frame(state, body, check);
    const bool reframes = frame.has_value();
    const bool had_regions = body.matches_shape() && body.shape.built, was_apart = body.apart;
    const auto due = [&] { return body.matches_shape() && !body.shape.built; };
    // A reference shape outlives the step: nothing that is not finite may get into it.
    if (yields || due()) check_damage(state);
    if (yields || reframes) {
      if (had_regions) find_parts(body.shape, state.parts_before);
      if (reframes) {
        take_frame(state, body, *frame);
      } else if (!had_regions || !update_part(state, body)) {
        if (had_regions) kick_by_pull(state, body, 0.5f);
        take_reference(state, body);
        if (had_regions) sort_parts(state.region_scratch.pillars.order.span(), state.parts_before);
      }
      body.apart = true;
      state.events.push_back({BodyEvent::Kind::yielded, body.id});
      ++updated;
    }
    const bool builds = due();
    if (builds) build_regions(state.execution, state.region_scratch, body.shape);
    if (!body.apart || !(yields || reframes || builds) || !body.shape.built) continue;
    find_parts(body.shape, state.parts_after);
    judge_parts(state, body, was_apart);
    if ((yields || reframes) && had_regions) tell_parts(state, body);
  }
  state.matched.clear();
  for (BodyState* body : state.awake)
    if (body->matches_shape())
      state.matched.add(body->shape, body->begin, flow_rule(body->material->settings));
  return updated;
}

void sort_fluids(Simulation::State& state) {
  const CellGrid& grid = state.sph.grid;
  if (state.step % k_sort_interval != 1 || grid.order.size() != state.store.size()) return;
  for (const BodyState& body : state.bodies) {
    if (body.keeps_reference() || !body.moves()) continue;
    std::size_t count = 0;
    state.fluid_order.resize(body.size());
    for (const std::uint32_t row : grid.order)
      if (row >= body.begin && row < body.end)
        state.fluid_order[count++] = row - static_cast<std::uint32_t>(body.begin);
    state.store.permute(body.begin, state.fluid_order.span(), state.execution.threads);
    state.rows_moved();
  }
}

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
  find_walls(state.store.position, state.store.velocity, state.placed_colliders, state.support_radius(),
             state.execution, walls);
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

void rub_walls(Simulation::State& state, float time_step) {
  ParticleStore& store = state.store;
  rub_walls({.position = store.position,
             .before = store.velocity,
             .pin = store.pin.empty() ? nullptr : store.pin.data(),
             .time_step = time_step},
            state.placed_colliders, state.execution, state.sph.walls, store.next_velocity);
  add_wall_loads(state, state.sph.walls.rubbed, time_step);
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
      .colliders = state.placed_colliders,
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
  state.moving.loads.assign(any_measures_load(state.placed_colliders) ? state.colliders.size() : 0, {});
  if (state.walls()) {
    for (std::size_t c = 0; c < state.moving.loads.size(); ++c) {
      const ColliderLoad& load = state.sph.walls.loads[c];
      state.moving.loads[c].impulse = static_cast<double>(time_step) * load.impulse;
      state.moving.loads[c].torque = static_cast<double>(time_step) * load.torque;
    }
  }
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
    if (state.moving.inputs[b].measure_rigid) body.rigid = rigid_motion(sums.rigid, body.rigid.center);
  }
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
  const NearBlocks& near = state.contact_pairs.near;
  if (near.row.empty()) return;
  std::vector<std::uint32_t> pushed;
  for (std::size_t k = 0; k < state.contact_pairs.sides.size(); ++k) {
    const std::uint32_t body = near.blocks.blocks[k].range;
    if (state.bodies[body].island == 0 || (!pushed.empty() && pushed.back() == body)) continue;
    const auto moves = [&](const BlockSides::Touching& point) {
      return !state.contact_pairs.velocity[point.point].velocity.isZero(0);
    };
    if (std::ranges::any_of(state.contact_pairs.sides[k].points, moves)) pushed.push_back(body);
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
                         .reach = 2 * state.support_radius(),
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

// Bodies at rest, as engines of rigid bodies have it: those that touch fall asleep together and wake
// together.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/bounds.h"
#include "mallow/defaults.h"
#include "simulation/phases.h"
#include "simulation/state.h"

namespace mallow {
namespace {

/// Of what is left out: speed in spacings in a Δt0, time in Δt0.
constexpr float k_sleep_speed = 0.005f, k_sleep_time = 60;

/// Flows on however slowly it does: a fluid thicker than the default, or what creeps under any load.
bool creeps(const Simulation::State& state, const BodyState& body) {
  constexpr float k_thick = 2;
  const Material& material = body.material->settings;
  if (body.keeps_reference()) return material.plastic_creep && material.plastic_yield == 0.0f;
  const float density = body.mass / (body.spacing * body.spacing * body.spacing);
  return body.viscosity > k_thick * density * default_kinematic_viscosity(state.scale, state.scene_step());
}

}  // namespace

double sleep_speed(const Simulation::State& state, const BodyState& body) {
  if (!state.bodies_sleep() || body.is_heated) return 0;
  if (!state.config.sleep_speed && creeps(state, body)) return 0;
  return static_cast<double>(
      state.config.sleep_speed.value_or(k_sleep_speed * body.spacing / state.scene_step()));
}

// Left out, longer than what is thrown up is slow at its highest: in steps much shorter than gravity asks
// for bodies fell asleep in the air.
double sleep_time(const Simulation::State& state, const BodyState& body) {
  constexpr double k_turning = 3;  // speeds by gravity; two of them is as long as that takes
  if (state.config.sleep_time) return static_cast<double>(*state.config.sleep_time);
  const double time = static_cast<double>(k_sleep_time * state.scene_step());
  const double gravity = static_cast<double>(state.config.gravity.norm());
  return gravity > 0 ? std::max(time, k_turning * sleep_speed(state, body) / gravity) : time;
}

namespace {

/// In the step that begins now.
bool is_moving(const Simulation::State& state, const Collider& collider) {
  if (!collider.surface_velocity.isZero(0)) return true;
  if (collider.keyframes.empty()) return !collider.velocity.isZero(0) || !collider.angular_velocity.isZero(0);
  return are_due(collider.keyframes, state.time, static_cast<double>(state.longest_step()));
}

/// Whether a collider may touch what is in a box.
bool is_near(const Simulation::State& state, const Collider& collider, const Aabb& box, float spacing) {
  const Vec3 middle = state.far(0.5f * (box.min + box.max));
  const float touches = std::max(state.config.contact_offset.value_or(0), spacing);
  return !(nearest(collider, middle).distance > 0.5f * (box.max - box.min).norm() + touches);
}

bool is_near_moving(const Simulation::State& state, const Aabb& box, float spacing) {
  return std::ranges::any_of(state.colliders, [&](const Collider& collider) {
    return is_moving(state, collider) && is_near(state, collider, box, spacing);
  });
}

Aabb box_of(const Simulation::State& state, const BodyState& body) {
  return box_around(state.store.position, body.begin, body.end);
}

/// A pin takes it along, or something that moves is beside it.
bool is_kept_awake(const Simulation::State& state, const BodyState& body) {
  if (!state.store.pin.empty())
    for (std::size_t row = body.begin; row < body.end; ++row)
      if (const std::uint16_t pin = state.store.pin[row])
        if (const PinState& moving = state.pins[pin - 1u]; !moving.velocity.isZero(0) || moving.seconds > 0)
          return true;
  return is_near_moving(state, box_of(state, body), body.spacing);
}

/// Those that have a pair of particles near enough to touch, are parts of one, or fell asleep together.
void find_islands(Simulation::State& state) {
  Islands& islands = state.islands;
  const auto n = static_cast<std::uint32_t>(state.bodies.size());
  islands.sets.reset(n);
  islands.first_of_group.assign(state.sph.groups.size(), UINT32_MAX);
  islands.first_of_sleepers.assign(state.body_slots.size() + 1, UINT32_MAX);
  const auto join_first = [&](std::uint32_t& first, std::uint32_t body) {
    if (first == UINT32_MAX) first = body;
    islands.sets.join(first, body);
  };
  for (std::uint32_t b = 0; b < n; ++b) {
    if (!state.bodies[b].enabled) continue;
    join_first(islands.first_of_group[state.bodies[b].sph_group], b);
    if (state.bodies[b].island != 0) join_first(islands.first_of_sleepers[state.bodies[b].island], b);
  }
  const ContactPairs& pairs = state.contact_pairs;
  if (!state.bodies_touch() || pairs.points.empty()) return;
  for (std::size_t k = 0; k < pairs.blocks.size(); ++k)
    for (const BlockPairs::OtherBody& other : pairs.blocks[k].bodies)
      islands.sets.join(pairs.near.blocks.blocks[k].range, other.body);
}

void fall_asleep(Simulation::State& state, std::uint32_t island, BodyState& body) {
  if (body.island == 0) state.events.push_back({BodyEvent::Kind::slept, body.id});
  body.island = island;
  body.judged_external = 0;
  body.recent_external.clear();
  body.measures_external = false;
  body.mean_speed = 0;
  body.box = box_of(state, body);
  for (std::size_t a = 0; a < 3; ++a)
    std::fill(state.store.velocity.axis(a) + body.begin, state.store.velocity.axis(a) + body.end, 0.0f);
  body.rigid.velocity.setZero();
  body.rigid.spin.setZero();
  body.rigid.deformation_speed = 0;
}

/// bodies -> the bodies of each island.
void list_islands(Simulation::State& state) {
  Islands& islands = state.islands;
  islands.first_of.assign(state.body_slots.size() + 2, 0);
  for (const BodyState& body : state.bodies) ++islands.first_of[body.island];
  std::partial_sum(islands.first_of.begin(), islands.first_of.end(), islands.first_of.begin());
  islands.by_island.resize(state.bodies.size());
  for (std::size_t b = state.bodies.size(); b-- > 0;)
    islands.by_island[--islands.first_of[state.bodies[b].island]] = static_cast<std::uint32_t>(b);
}

}  // namespace

bool are_due(std::span<const PoseKeyframe> keyframes, double time, double longest_step) {
  return keyframes.back().time > time && keyframes.front().time < time + longest_step;
}

void wake_island(Simulation::State& state, BodyState& body) {
  body.slow_time = 0;
  if (body.island == 0) return;
  const std::uint32_t island = body.island;
  Islands& islands = state.islands;
  if (islands.by_island.empty()) list_islands(state);
  for (std::uint32_t k = islands.first_of[island]; k < islands.first_of[island + 1]; ++k) {
    BodyState& other = state.bodies[islands.by_island[k]];
    if (other.island != island) continue;
    other.island = 0;
    other.slow_time = 0;
    other.resting.clear();
    state.next_events.push_back({BodyEvent::Kind::woke, other.id});
  }
}

void wake_all(Simulation::State& state) {
  for (BodyState& body : state.bodies) {
    if (body.island != 0) state.next_events.push_back({BodyEvent::Kind::woke, body.id});
    body.island = 0;
    body.slow_time = 0;
    body.resting.clear();
  }
}

void wake_near(Simulation::State& state, const Collider& collider) {
  for (BodyState& body : state.bodies)
    if (body.island != 0 && is_near(state, collider, body.box, body.spacing)) wake_island(state, body);
}

void wake_pinned(Simulation::State& state, PinId pin) {
  for (std::size_t row = 0; row < state.store.pin.size(); ++row)
    if (state.store.pin[row] == slot_of(pin) + 1) wake_island(state, state.body_of(row));
}

void hold_sleepers(Simulation::State& state) {
  state.held = true;
  ParticleStore& store = state.store;
  for (BodyState& body : state.bodies) {
    if (body.moves()) continue;
    body.box = box_of(state, body);
    for (std::size_t a = 0; a < 3; ++a) {
      std::copy(store.position.axis(a) + body.begin, store.position.axis(a) + body.end,
                store.next_position.axis(a) + body.begin);
      std::copy(store.velocity.axis(a) + body.begin, store.velocity.axis(a) + body.end,
                store.next_velocity.axis(a) + body.begin);
    }
  }
}

namespace {

/// What sleeps is not sorted into cells, but their size does not change with it.
void leave_out_sleepers(Simulation::State& state) {
  CellGrid& grid = state.sph.grid;
  grid.points_beside = 0;
  grid.box_beside = empty_box();
  for (const BodyState& body : state.bodies) {
    if (!body.enabled || body.moves()) continue;
    grid.points_beside += body.size();
    grid.box_beside = box_around(grid.box_beside, body.box);
  }
}

}  // namespace

void wake_bodies(Simulation::State& state) {
  if (!state.held) hold_sleepers(state);
  for (BodyState& body : state.bodies)
    if (body.island != 0 && is_near_moving(state, body.box, body.spacing)) wake_island(state, body);
  state.events.swap(state.next_events);
  state.next_events.clear();
  state.events_of_calls = state.events.size();
  state.awake.clear();
  for (BodyState& body : state.bodies)
    if (body.moves()) state.awake.push_back(&body);
  Column<std::uint32_t>& rows = state.sph.rows;
  rows.resize(0);
  leave_out_sleepers(state);
  if (state.awake.size() == state.bodies.size()) return;
  std::size_t count = 0;
  for (const BodyState* body : state.awake) count += body->size();
  rows.resize_unset(count);
  std::uint32_t* at = rows.data();
  for (const BodyState* body : state.awake)
    for (std::size_t row = body->begin; row < body->end; ++row) *at++ = static_cast<std::uint32_t>(row);
}

void rest_bodies(Simulation::State& state, float time_step) {
  if (!state.bodies_sleep()) return;
  bool any_ready = false;
  for (BodyState* body : state.awake) {
    const double speed = sleep_speed(state, *body);
    const bool slow = body->mean_speed < speed;
    body->slow_time = slow ? body->slow_time + static_cast<double>(time_step) : 0;
    if (!(body->slow_time >= sleep_time(state, *body))) continue;
    if (is_kept_awake(state, *body))
      body->slow_time = 0;
    else
      any_ready = true;
  }
  if (!any_ready) return;
  find_islands(state);
  Islands& islands = state.islands;
  const auto root = [&](const BodyState& body) { return islands.sets.root(state.place_of(body)); };
  // One whose bodies all sleep already goes on as it is.
  islands.rests.assign(state.bodies.size(), false);
  for (const BodyState* body : state.awake) islands.rests[root(*body)] = true;
  for (const BodyState* body : state.awake)
    if (!(body->slow_time >= sleep_time(state, *body))) islands.rests[root(*body)] = false;
  bool any = false;
  for (BodyState& body : state.bodies) {
    if (!body.enabled || !islands.rests[root(body)]) continue;
    fall_asleep(state, slot_of(state.bodies[root(body)].id) + 1, body);
    any = true;
  }
  if (!any) return;
  keep_loads(state, static_cast<double>(time_step));
  islands.by_island.clear();
  hold_sleepers(state);
  state.sph.kept.forget();
}

}  // namespace mallow

// Bodies at rest, as engines of rigid bodies have it: those that touch fall asleep together and wake
// together.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/bounds.h"
#include "simulation/state.h"

namespace mallow {
namespace {

/// Of what is left out: speed in spacings in a Δt0, time in Δt0.
constexpr float k_sleep_speed = 0.005f, k_sleep_time = 60;

double sleep_speed(const Simulation::State& state, const BodyState& body) {
  return static_cast<double>(
      state.config.sleep_speed.value_or(k_sleep_speed * body.spacing / state.base_step()));
}

double sleep_time(const Simulation::State& state) {
  return static_cast<double>(state.config.sleep_time.value_or(k_sleep_time * state.base_step()));
}

/// In the step that begins now.
bool is_moving(const Simulation::State& state, const Collider& collider) {
  if (!collider.surface_velocity.isZero(0)) return true;
  if (collider.keyframes.empty()) return !collider.velocity.isZero(0) || !collider.angular_velocity.isZero(0);
  return collider.keyframes.back().time > state.time &&
         collider.keyframes.front().time < state.time + static_cast<double>(state.longest_step());
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

/// Which bodies touch each other, by union and find.
class Islands {
 public:
  Islands(std::vector<std::uint32_t>& of, std::size_t bodies) : of_(of) {
    of_.resize(bodies);
    std::iota(of_.begin(), of_.end(), 0u);
  }
  std::uint32_t root(std::uint32_t body) {
    while (of_[body] != body) body = of_[body] = of_[of_[body]];
    return body;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    of_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t>& of_;
};

/// Those that have a pair of particles near enough to touch, are parts of one, or fell asleep together.
Islands find_islands(Simulation::State& state) {
  const std::size_t n = state.bodies.size();
  Islands islands(state.island_of, n);
  std::vector<std::uint32_t> first_of_group(state.sph.groups.size(), UINT32_MAX),
      first_of_island(state.islands + 1, UINT32_MAX);
  const auto join_first = [&](std::uint32_t& first, std::uint32_t body) {
    if (first == UINT32_MAX) first = body;
    islands.join(first, body);
  };
  for (std::uint32_t b = 0; b < n; ++b) {
    if (!state.bodies[b].enabled) continue;
    join_first(first_of_group[state.bodies[b].sph_group], b);
    if (const std::uint32_t island = state.bodies[b].island) join_first(first_of_island[island], b);
  }
  if (!state.bodies_touch()) return islands;
  const ContactPairs& pairs = state.contact_pairs;
  const NearBlocks& near = pairs.near;
  if (near.row.empty()) return islands;
  for (std::size_t k = 0; k < pairs.blocks.size(); ++k)
    for (const ContactPair& pair : pairs.blocks[k].pairs) {
      const auto body =
          static_cast<std::uint32_t>(&state.body_of(near.row[pair.other]) - state.bodies.data());
      islands.join(near.blocks.blocks[k].range, body);
    }
  return islands;
}

void fall_asleep(Simulation::State& state, std::uint32_t island, BodyState& body) {
  if (body.island == 0) state.events.push_back({BodyEvent::Kind::slept, body.id});
  body.island = island;
  body.external_sum = body.external_weight = body.step_weight = 0;
  body.mean_speed = 0;
  body.box = box_of(state, body);
  for (std::size_t a = 0; a < 3; ++a)
    std::fill(state.store.velocity.axis(a) + body.begin, state.store.velocity.axis(a) + body.end, 0.0f);
  body.rigid.velocity.setZero();
  body.rigid.spin.setZero();
  body.rigid.deformation_speed = 0;
}

}  // namespace

void wake_island(Simulation::State& state, BodyState& body) {
  body.slow_time = 0;
  if (body.island == 0) return;
  const std::uint32_t island = body.island;
  for (BodyState& other : state.bodies) {
    if (other.island != island) continue;
    other.island = 0;
    other.slow_time = 0;
    state.next_events.push_back({BodyEvent::Kind::woke, other.id});
  }
}

void wake_all(Simulation::State& state) {
  for (BodyState& body : state.bodies) wake_island(state, body);
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

void wake_bodies(Simulation::State& state) {
  if (!state.held) hold_sleepers(state);
  if (state.disturbed) wake_all(state);
  state.disturbed = false;
  for (BodyState& body : state.bodies)
    if (body.island != 0 && is_near_moving(state, body.box, body.spacing)) wake_island(state, body);
  state.events.swap(state.next_events);
  state.next_events.clear();
  state.awake.clear();
  for (BodyState& body : state.bodies)
    if (body.moves()) state.awake.push_back(&body);
  Column<std::uint32_t>& rows = state.sph.rows;
  rows.resize(0);
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
    if (!(body->slow_time >= sleep_time(state))) continue;
    if (is_kept_awake(state, *body))
      body->slow_time = 0;
    else
      any_ready = true;
  }
  if (!any_ready) return;
  Islands islands = find_islands(state);
  std::vector<bool> rests(state.bodies.size(), true);
  const auto root = [&](const BodyState& body) {
    return islands.root(static_cast<std::uint32_t>(&body - state.bodies.data()));
  };
  for (const BodyState* body : state.awake)
    if (!(body->slow_time >= sleep_time(state))) rests[root(*body)] = false;
  std::vector<std::uint32_t> number(state.bodies.size(), 0);
  for (const BodyState* body : state.awake)
    if (rests[root(*body)] && number[root(*body)] == 0) number[root(*body)] = ++state.islands;
  bool any = false;
  for (BodyState& body : state.bodies) {
    const std::uint32_t island = body.enabled ? number[root(body)] : 0;
    if (island == 0) continue;
    fall_asleep(state, island, body);
    any = true;
  }
  if (!any) return;
  hold_sleepers(state);
  state.sph.kept.forget();
}

}  // namespace mallow

// Who begins to touch whom, how hard, and who ceases to: what events() tells games.
#include <algorithm>
#include <cmath>

#include "core/checks.h"
#include "simulation/phases.h"
#include "simulation/state.h"

namespace mallow {
namespace {

using Vec = Eigen::Vector3d;

/// A contact is over once nothing has pushed for longer than this, in Δt0: a hop that takes so long rises by
/// a seventieth of a spacing. A stiff cube that falls ten spacings and trembles is told to touch the floor 9
/// times until it rests; without this 14 times.
constexpr double k_apart = 4;

/// What one body of a pair asks for; null where it is gone or not enabled.
const BodyState* find_body(const Simulation::State& s, std::uint64_t id) {
  const std::optional<std::size_t> index = s.body_slots.find(id);
  return index && s.bodies[*index].enabled ? &s.bodies[*index] : nullptr;
}

/// Both sides of a contact as they are now.
struct Sides {
  const BodyState* body = nullptr;
  const BodyState* other = nullptr;
  const Collider* collider = nullptr;

  Sides(const Simulation::State& s, const ContactKey& key) : body(find_body(s, key.body)) {
    if (key.of_bodies)
      other = find_body(s, key.other);
    else if (const std::optional<std::size_t> index = s.collider_slots.find(key.other))
      collider = &s.colliders[*index];
  }
  bool exist() const { return body && (other || collider); }
  bool sleep() const { return !body->moves() && !(other && other->moves()); }
  /// The least that one of them asks for; none where nobody asks.
  std::optional<double> hit_impulse() const {
    if (!other || !other->hit_impulse) return body->hit_impulse;
    return std::min(*other->hit_impulse, body->hit_impulse.value_or(*other->hit_impulse));
  }
};

/// What touches in this step, in the order of events, each pair once. What walls press on a fluid that
/// touches them is part of its impulse.
void find_touching(Simulation::State& s, double time_step) {
  std::vector<Contacts::Found>& found = s.contacts.found;
  found.clear();
  const auto add = [&](const ContactKey& key, const ContactSums& sums) {
    found.push_back({key, found.size(), sums});
  };
  const MovingBodies& moving = s.moving;
  const std::size_t colliders = moving.touches.empty() ? 0 : s.colliders.size();
  for (std::size_t b = 0; b < moving.partial.size() && colliders > 0; ++b)
    for (std::size_t c = 0; c < colliders; ++c) {
      const ContactSums& sums = moving.touches[b * colliders + c];
      if (!(sums.weight > 0)) continue;
      const BodyState& body = *s.awake[moving.blocks.blocks[b].range];
      add({static_cast<std::uint64_t>(body.id), false, s.collider_ids[c]},
          sums.times(static_cast<double>(body.mass)));
    }
  const Walls& walls = s.sph.walls;
  if (s.walls() && walls.any && !walls.loads.empty())
    for (std::size_t k = 0; k < walls.partial_loads.size(); ++k) {
      const std::size_t c = k % walls.loads.size(), block = k / walls.loads.size();
      const BodyState& body = s.body_of(walls.bodies[walls.blocks.blocks[block].range].begin);
      const ColliderLoad& load = walls.partial_loads[k];
      const Vec pressed = -time_step * load.impulse;
      const Vec center = s.colliders[c].pose.translation - s.origin.cast<double>();
      if (!pressed.isZero(0))
        add({static_cast<std::uint64_t>(body.id), false, s.collider_ids[c]},
            {.impulse = pressed, .moment = center.cross(pressed) - time_step * load.torque});
    }
  s.contacts.touches.clear();
  if (s.bodies_touch() && !s.awake.empty())
    list_touches(s.store.velocity, s.contact_pairs, s.contacts.touches);
  for (const BodyTouch& touch : s.contacts.touches) {
    const auto a = static_cast<std::uint64_t>(s.bodies[touch.body].id);
    const auto b = static_cast<std::uint64_t>(s.bodies[touch.other].id);
    if (a < b)
      add({a, true, b}, touch.sums);
    else
      add({b, true, a}, touch.sums.swapped());
  }
  std::ranges::sort(found, [](const Contacts::Found& a, const Contacts::Found& b) {
    return a.key != b.key ? a.key < b.key : a.order < b.order;
  });
  std::size_t count = 0;
  for (const Contacts::Found& part : found)
    if (count > 0 && found[count - 1].key == part.key)
      found[count - 1].sums += part.sums;
    else
      found[count++] = part;
  found.resize(count);
  std::erase_if(found, [](const Contacts::Found& one) { return !(one.sums.weight > 0); });
}

BodyEvent event_of(BodyEvent::Kind kind, const ContactKey& key) {
  BodyEvent event{.kind = kind, .body = BodyId{key.body}};
  if (key.of_bodies)
    event.other = BodyId{key.other};
  else
    event.collider = ColliderId{key.other};
  return event;
}

/// Where, which way and how hard.
BodyEvent describe(const Simulation::State& s, const Contacts::Found& found, const Collider* collider) {
  BodyEvent event = event_of(BodyEvent::Kind::touched, found.key);
  const ContactSums& sums = found.sums;
  Vec x = sums.position / sums.weight + s.origin.cast<double>(), v = sums.velocity / sums.weight;
  Vec normal = sums.normal.norm() > 0 ? sums.normal.normalized() : Vec(0, 0, 0);
  if (collider) {
    const SurfacePoint surface = nearest(*collider, x.cast<float>());
    normal = surface.normal.cast<double>();
    v -= collider->velocity.cast<double>() +
         collider->angular_velocity.cast<double>().cross(x - collider->pose.translation);
    x -= static_cast<double>(surface.distance) * normal;
  }
  event.position = x.cast<float>();
  event.normal = normal.cast<float>();
  event.impulse = sums.impulse.cast<float>();
  const Vec moment = (x - s.origin.cast<double>()).cross(sums.impulse);  // of the impulse at `position`
  event.torque = Vec(sums.moment - moment).cast<float>();
  if (!collider) event.other_torque = Vec(sums.other_moment + moment).cast<float>();
  event.speed = static_cast<float>(std::max(0.0, -v.dot(normal)));
  return event;
}

void check_impulse(std::optional<double> hit_impulse) {
  Checks checks;
  if (hit_impulse && !(*hit_impulse >= 0)) checks.problem("hit_impulse", "must be 0 or above");
  checks.finish();
}

}  // namespace

void tell_contacts(Simulation::State& state, float time_step) {
  Contacts& contacts = state.contacts;
  if (!state.reports_contacts() && contacts.lasting.empty()) return;
  find_touching(state, static_cast<double>(time_step));
  contacts.next.clear();
  auto found = contacts.found.begin();
  // One that touches; was: whether it did before.
  const auto touch = [&](bool was) {
    const Sides sides(state, found->key);
    if (const std::optional<double> hit_impulse = sides.hit_impulse()) {
      BodyEvent event = describe(state, *found, sides.collider);
      if (!was) state.events.push_back(event);
      event.kind = BodyEvent::Kind::hit;
      if (found->sums.impulse.norm() >= *hit_impulse) state.events.push_back(event);
      contacts.next.push_back({found->key});
    }
    ++found;
  };
  for (Contacts::Lasting& contact : contacts.lasting) {
    while (found != contacts.found.end() && found->key < contact.key) touch(false);
    if (found != contacts.found.end() && found->key == contact.key) {
      touch(true);
      continue;
    }
    const Sides sides(state, contact.key);
    const bool exists = sides.exist();
    if (exists && !sides.hit_impulse()) continue;
    if (exists && !sides.sleep()) contact.apart += static_cast<double>(time_step);
    if (exists && contact.apart <= k_apart * static_cast<double>(state.base_step()))
      contacts.next.push_back(contact);
    else
      state.events.push_back(event_of(BodyEvent::Kind::parted, contact.key));
  }
  while (found != contacts.found.end()) touch(false);
  contacts.lasting.swap(contacts.next);
}

void Simulation::report_contacts(std::optional<double> hit_impulse) {
  state_->refuse_in_callback();
  check_impulse(hit_impulse);
  state_->contacts.hit_impulse = hit_impulse;
  for (BodyState& body : state_->bodies) body.hit_impulse = hit_impulse;
}

void Simulation::report_contacts(BodyId id, std::optional<double> hit_impulse) {
  state_->refuse_in_callback();
  BodyState& body = state_->body(id);
  check_impulse(hit_impulse);
  body.hit_impulse = hit_impulse;
}

}  // namespace mallow

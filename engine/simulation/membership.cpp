// What comes and goes while a simulation runs.
#include "simulation/membership.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "colliders/collider_checks.h"
#include "colliders/pose.h"
#include "config/validation.h"
#include "core/bounds.h"
#include "core/box_tree.h"
#include "shape_matching/reshape.h"
#include "simulation/overlaps.h"
#include "simulation/phases.h"
#include "simulation/settings.h"
#include "simulation/state.h"
#include "simulation/stiffness.h"

namespace mallow {
namespace {

/// The particles of one body share their spacing to this relative difference.
constexpr float k_same_spacing = 1e-3f;

/// Bodies behind one whose rows have become more, or fewer.
void shift_rows(Simulation::State& s, const BodyState& body, std::size_t old_end) {
  for (BodyState& other : s.bodies) {
    if (&other == &body || other.begin < old_end) continue;
    other.begin = other.begin + body.end - old_end;
    other.end = other.end + body.end - old_end;
  }
}

struct Points {
  Vec3 origin;
  std::vector<Vec3> positions, velocities;  ///< relative to the origin
};

Points points_of(const Simulation::State& s, const Body& points) {
  Points relative{.origin = s.store.size() == 0 ? choose_origin(points) : s.origin,
                  .positions = {},
                  .velocities = std::vector<Vec3>(points.positions.size(), points.velocity)};
  relative.positions.reserve(points.positions.size());
  for (const Vec3& x : points.positions) relative.positions.push_back(relative_to(relative.origin, x));
  for (std::size_t i = 0; i < points.velocities.size(); ++i) relative.velocities[i] += points.velocities[i];
  return relative;
}

/// Throws ConfigError.
Points checked_points(Simulation::State& s, const BodyState& body, const Body& points) {
  Points checked = points_of(s, points);
  float fastest = 0;
  for (const Vec3& v : checked.velocities) fastest = std::max(fastest, v.stableNorm());
  Checks checks;
  check_speed(s, "body.velocity", static_cast<double>(fastest), checks);
  checks.finish();
  refuse_overlaps(s, body, checked.positions, points.spacing, checked.origin);
  check_neighbors(s, body.material->settings, points);
  return checked;
}

/// Puts points behind the last row of a body.
void insert_points(Simulation::State& s, const Points& points, const Body& given, BodyState& body) {
  if (s.store.size() == 0) s.origin = points.origin;
  const std::size_t begin = body.end;
  PlacedRows placed;
  if (begin == s.store.size()) std::swap(placed, s.placed);  // the other rows stay
  s.store.insert(begin, points.positions, points.velocities);
  body.end += points.positions.size();
  paint_rows(s, body, begin, given);
  warm_rows(s, body, begin, given);
  s.rows_changed();
  std::swap(placed, s.placed);
  s.placed.extend(s.store.position);
}

std::vector<std::uint32_t> rows_of(const Simulation::State& s, std::span<const ParticleId> ids) {
  std::vector<std::uint32_t> rows;
  rows.reserve(ids.size());
  for (const ParticleId id : ids) {
    const std::optional<std::size_t> row = s.store.slots.find(id);
    if (!row) throw ConfigError("particle", why_unknown(s.store, id));
    rows.push_back(static_cast<std::uint32_t>(*row));
  }
  std::ranges::sort(rows);
  if (const auto twice = std::ranges::adjacent_find(rows); twice != rows.end())
    throw ConfigError("particle", "particle " + std::to_string(s.store.id[*twice]) + " is given twice");
  return rows;
}

std::vector<ParticleId> ids_in(const Simulation::State& s, const Aabb& region, const char* field) {
  std::vector<ParticleId> ids;
  for (std::size_t row = 0; row < s.store.size(); ++row) {
    const Vec3 x = s.far(s.store.position.get(row));
    if (is_near(x, region)) ids.push_back(s.store.id[row]);
  }
  if (!ids.empty()) return ids;
  std::ostringstream text;
  text << "no particle is between (" << region.min.transpose() << ") and (" << region.max.transpose() << ')';
  throw ConfigError(field, text.str());
}

/// Bodies that sleep beside one of these boxes wake: what they lean on is gone.
void wake_beside(Simulation::State& s, std::span<const Aabb> boxes) {
  BoxTree tree;
  tree.build(boxes);
  for (BodyState& body : s.bodies) {
    if (body.island == 0) continue;
    const float reach = 2 * body.spacing;
    const Vec3 around = Vec3::Constant(reach);
    bool is_beside = false;
    tree.for_overlapping({body.box.min - around, body.box.max + around},
                         [&](std::uint32_t b) { is_beside |= are_near(body.box, boxes[b], reach); });
    if (is_beside) wake_island(s, body);
  }
}

/// Takes rows of one body out, ascending and not all of them.
void remove_rows(Simulation::State& s, BodyState& body, std::span<const std::uint32_t> rows) {
  ShapeMatching& shape = body.shape;
  std::vector<std::uint32_t> places;
  for (const std::uint32_t row : rows) places.push_back(row - static_cast<std::uint32_t>(body.begin));
  const bool built = shape.built, kept = shape.reference.size() == body.size();
  CarriedRegions carried;
  HeldTogether held;
  if (built) {
    held = held_together_by(places, shape);
    carried = carry_regions(shape);
  }
  s.store.erase(rows);
  const std::size_t old_end = body.end;
  body.end -= rows.size();
  shift_rows(s, body, old_end);
  s.rows_changed();
  if (!kept) {
    shape.reference.resize(0);
    shape.built = false;
    return;
  }
  erase_from_reference(places, carried, shape);
  if (!built) return;
  rebuild_shape(s, body, carried);
  if (!are_torn(held, carried.former, shape, s.parts_after)) return;
  body.apart = true;  // nothing holds its parts to one rigid motion
  s.next_events.push_back({.kind = BodyEvent::Kind::torn,
                           .body = body.id,
                           .parts = s.parts_after.count,
                           .crumbs = s.parts_after.crumbs});
}

}  // namespace

void rebuild_shape(Simulation::State& s, BodyState& body, CarriedRegions& carried) {
  PillarOrder& pillars = s.region_scratch.pillars;
  sort_reference(s.execution, pillars, body.shape);
  s.store.permute(body.begin, pillars.order.span(), s.execution.threads);
  sort_carried(pillars.order.span(), carried);
  build_carried(carried, s.execution, s.region_scratch, body.shape);
  measure_rigid(s, body);
  s.held = false;
}

void forget_bodies(Simulation::State& s, std::span<BodyState* const> gone) {
  for (const BodyState* body : gone) {
    s.body_names.erase(*body);
    s.body_slots.give_back(static_cast<std::uint64_t>(body->id));
    leave_material(s, *body->material);
  }
  s.bodies.erase_if(
      [&](const BodyState& body) { return !s.body_slots.find(static_cast<std::uint64_t>(body.id)); });
  number_bodies(s);
}

void number_bodies(Simulation::State& s) {
  s.islands.by_island.clear();
  for (std::size_t b = 0; b < s.bodies.size(); ++b)
    s.body_slots.index[slot_of(s.bodies[b].id)] = static_cast<std::uint32_t>(b);
}

void Simulation::State::rows_changed() {
  rows_moved();
  sph.grid.order.resize(0);
  sph_ran = density_ran = false;
  prepared = false;
  held = false;
  blend_changed = true;
}

namespace {

/// A body of these points, whose rows are there. Throws ConfigError, and changes nothing.
BodyState place_points(Simulation::State& s, const Body& points, MaterialState& material, std::string name) {
  Checks checks;
  check(points, checks);
  checks.finish();
  BodyState body;
  body.name = name.empty() ? "body " + std::to_string(s.body_slots.given()) : std::move(name);
  body.material = &material;
  body.merges = points.merges;
  body.splits = points.splits;
  body.hit_impulse = s.contacts.hit_impulse;
  body.begin = body.end = s.store.size();
  body.spacing = points.spacing;
  body.shape.region_radius = region_radius(s.config, material.settings, body.spacing);
  body.shape.region_stride = material.settings.region_stride;
  body.shape.flows = flows(material.settings);
  check_modulus(s.config, material.settings, body, checks);
  checks.finish();
  derive_density(s.config, body);
  check_elasticity(s, body, points);
  refuse_yields(body, points);
  refuse_temperatures(body, points);
  insert_points(s, checked_points(s, body, points), points, body);
  return body;
}

BodyId keep_body(Simulation::State& s, BodyState body) {
  const std::uint64_t number = s.body_slots.take();
  s.body_slots.place(s.bodies.size(), {&number, 1});
  body.id = BodyId{number};
  ++body.material->bodies;
  s.body_names.add(body);
  s.bodies.push_back(std::move(body));
  return BodyId{number};
}

}  // namespace

BodyId Simulation::add_body(const Body& points, MaterialId id, std::string name) {
  state_->refuse_in_callback();
  return keep_body(*state_, place_points(*state_, points, state_->material(id), std::move(name)));
}

BodyId Simulation::add_body(const Body& points, const Material& settings, std::string name) {
  state_->refuse_in_callback();
  Checks checks;
  check(points, checks);
  checks.finish();
  MaterialState material = checked_material(*state_, settings, name);
  BodyState body = place_points(*state_, points, material, std::move(name));
  material.stays = false;
  body.material = &keep_material(*state_, std::move(material));
  return keep_body(*state_, std::move(body));
}

void Simulation::extend_body(BodyId id, const Body& points) {
  state_->refuse_in_callback();
  State& s = *state_;
  BodyState& body = s.body(id);
  Checks checks;
  check(points, checks);
  if (!(std::abs(points.spacing - body.spacing) <= k_same_spacing * body.spacing)) {
    std::ostringstream text;
    text << points.spacing << " is not allowed in body '" << body.name << "', whose spacing is "
         << body.spacing << ": all particles of a body share one spacing";
    checks.problem("body.spacing", text.str());
  }
  checks.finish();
  checked_points(s, body, points);
  check_elasticity(s, body, points);
  refuse_temperatures(body, points);
  extend(s, body, points);
}

std::vector<ParticleId> extend(Simulation::State& s, BodyState& body, const Body& points) {
  const Points added = points_of(s, points);
  wake_island(s, body);
  const bool remembers = body.shape.built && !body.grew;
  CarriedRegions carried;
  if (remembers) {
    // As they are now, not as they were when the last step began.
    MatchedBodies matched;
    weigh_regions(s.execution.threads, s.store, body);
    matched.add(body.shape, body.begin);
    match_shapes(s.store.position, s.config.rotation_iterations, s.execution, matched);
    carried = carry_regions(body.shape);
    append_to_reference(s.store.position, body.begin, added.positions, s.execution, carried, body.shape);
  }
  const std::size_t old_end = body.end;
  insert_points(s, added, points, body);
  shift_rows(s, body, old_end);
  std::vector<ParticleId> ids(s.store.id.begin() + old_end, s.store.id.begin() + body.end);
  if (remembers)
    rebuild_shape(s, body, carried);
  else
    body.grew = true;
  return ids;
}

namespace {

/// All of some bodies, in the order of their rows.
void erase_bodies(Simulation::State& s, std::span<BodyState* const> erased) {
  std::vector<std::uint32_t> rows;
  std::vector<Aabb> boxes;
  for (BodyState* body : erased) {
    wake_island(s, *body);
    boxes.push_back(box_around(s.store.position, body->begin, body->end));
    for (std::size_t row = body->begin; row < body->end; ++row)
      rows.push_back(static_cast<std::uint32_t>(row));
  }
  s.store.erase(rows);
  std::size_t gone = 0;
  auto next = erased.begin();
  for (std::size_t b = s.place_of(*erased.front()); b < s.bodies.size(); ++b) {
    BodyState& body = s.bodies[b];
    const std::size_t size = body.size();
    body.begin -= gone;
    body.end -= gone;
    if (next == erased.end() || *next != &body) continue;
    body.end = body.begin;
    gone += size;
    ++next;
  }
  forget_bodies(s, erased);
  s.rows_changed();
  wake_beside(s, boxes);
}

}  // namespace

void Simulation::remove_body(BodyId id) {
  state_->refuse_in_callback();
  BodyState* body = &state_->body(id);
  erase_bodies(*state_, {&body, 1});
}

void Simulation::remove_particles(std::span<const ParticleId> ids) {
  state_->refuse_in_callback();
  erase_particles(*state_, ids);
}

void erase_particles(Simulation::State& s, std::span<const ParticleId> ids) {
  const std::vector<std::uint32_t> rows = rows_of(s, ids);
  std::vector<BodyState*> whole;
  // From the last body on: the rows of those before it stay where they are.
  for (std::size_t end = rows.size(); end > 0;) {
    BodyState& body = s.body_of(rows[end - 1]);
    std::size_t begin = end;
    while (begin > 0 && rows[begin - 1] >= body.begin) --begin;
    if (end - begin == body.size()) {
      whole.push_back(&body);
    } else {
      wake_island(s, body);
      remove_rows(s, body, std::span(rows).subspan(begin, end - begin));
    }
    end = begin;
  }
  std::ranges::reverse(whole);
  if (!whole.empty()) erase_bodies(s, whole);
}

std::size_t Simulation::remove_particles(const Aabb& region) {
  const std::vector<ParticleId> ids = ids_in(*state_, region, "region");
  remove_particles(ids);
  return ids.size();
}

std::vector<BodyId> Simulation::split(BodyId id) {
  state_->refuse_in_callback();
  BodyState& body = state_->body(id);
  prepare();
  return split_body(*state_, body);
}

ColliderId Simulation::add_collider(const Collider& collider) {
  state_->refuse_in_callback();
  State& s = *state_;
  Checks checks;
  check(collider, checks);
  checks.finish();
  const std::uint64_t id = s.collider_slots.take();
  s.collider_slots.place(s.colliders.size(), {&id, 1});
  s.collider_ids.push_back(id);
  s.colliders.push_back(collider);
  Collider& added = s.colliders.back();
  if (!added.keyframes.empty()) added.pose = pose_at(added.keyframes, s.time);
  wake_near(s, added);
  return ColliderId{id};
}

void Simulation::set_collider(ColliderId id, const Collider& collider) {
  state_->refuse_in_callback();
  State& s = *state_;
  Collider& kept = s.colliders[s.index(id)];
  Checks checks;
  check(collider, checks);
  checks.finish();
  wake_near(s, kept);
  kept = collider;
  if (!kept.keyframes.empty()) kept.pose = pose_at(kept.keyframes, s.time);
  wake_near(s, kept);
}

void Simulation::remove_collider(ColliderId id) {
  state_->refuse_in_callback();
  State& s = *state_;
  const auto at = static_cast<std::ptrdiff_t>(s.index(id));
  wake_near(s, s.colliders[s.index(id)]);
  s.colliders.erase(s.colliders.begin() + at);
  s.collider_ids.erase(s.collider_ids.begin() + at);
  if (static_cast<std::size_t>(at) < s.moving.loads.size()) s.moving.loads.erase(s.moving.loads.begin() + at);
  s.collider_slots.give_back(static_cast<std::uint64_t>(id));
  s.collider_slots.place(0, s.collider_ids);
}

void check_room_for_pin(const Simulation::State& s, Checks& checks) {
  if (s.pins.size() == k_max_pins && s.pin_slots.free.empty())
    checks.problem("pin", "at most " + std::to_string(k_max_pins) + " pins are possible");
}

PinId Simulation::pin(const Aabb& region, const Vec3& velocity) {
  return pin(ids_in(*state_, region, "pin.box"), velocity);
}

PinId Simulation::pin(std::span<const ParticleId> ids, const Vec3& velocity) {
  state_->refuse_in_callback();
  State& s = *state_;
  Checks checks;
  checks.vector("pin.velocity", velocity);
  for (const ParticleId id : ids) {
    if (s.store.slots.find(id)) continue;
    checks.problem("pin", why_unknown(s.store, id));
    break;
  }
  check_room_for_pin(s, checks);
  check_speed(s, "pin.velocity", velocity.cast<double>().norm(), checks);
  checks.finish();
  const std::uint64_t id = s.pin_slots.take();
  s.pin_slots.index[slot_of(id)] = slot_of(id);
  s.pins.resize(s.pin_slots.size());
  s.pins[slot_of(id)] = {.id = PinId{id}, .velocity = velocity};
  hold_particles(s, PinId{id}, ids);
  return PinId{id};
}

void hold_particles(Simulation::State& s, PinId pin, std::span<const ParticleId> ids) {
  if (s.store.pin.empty()) s.store.pin.resize(s.store.size());
  for (const ParticleId id : ids) {
    const std::size_t row = *s.store.slots.find(id);
    s.store.pin[row] = static_cast<std::uint16_t>(slot_of(pin) + 1);
    wake_island(s, s.body_of(row));
  }
}

void Simulation::unpin(PinId id) {
  state_->refuse_in_callback();
  release_pin(*state_, id);
}

void release_pin(Simulation::State& s, PinId id) {
  s.pin(id) = {};
  wake_pinned(s, id);
  for (std::uint16_t& pin : s.store.pin)
    if (pin == slot_of(id) + 1) pin = 0;
  s.pin_slots.give_back(static_cast<std::uint64_t>(id));
}

}  // namespace mallow

// What an application asks a simulation between steps. Each looks at all particles, block by block of those
// whose box is near.
#include <algorithm>
#include <cmath>
#include <limits>

#include "colliders/pose.h"
#include "colliders/shapes.h"
#include "core/bounds.h"
#include "core/checks.h"
#include "shape_matching/parts.h"
#include "simulation/phases.h"
#include "simulation/state.h"

namespace mallow {
namespace {

using Vec = Eigen::Vector3d;

/// Of the ball around a particle that rays meet, in spacings: no ray along a lattice slips between four.
constexpr double k_ball_radius = 0.75;

/// Calls visit(row, body) for the particles of enabled bodies that are in a box, which is relative to the
/// origin.
template <class Visit>
void for_rows_in(const Simulation::State& s, const Aabb& box, const Visit& visit) {
  for (const BodyState& body : s.bodies) {
    if (!body.enabled) continue;
    for (std::size_t row = body.begin; row < body.end; ++row) {
      const Vec3 x = s.store.position.get(row);
      if (is_near(x, box)) visit(row, body);
    }
  }
}

Aabb near_origin(const Simulation::State& s, const Aabb& box) {
  return {relative_to(s.origin, box.min), relative_to(s.origin, box.max)};
}

/// Where a ray first enters a ball, or 0 where it starts in it; infinite where it does not.
double enter(const Vec& from, const Vec& direction, const Vec& center, double radius) {
  const Vec r = from - center;
  const double along = r.dot(direction), inside = r.squaredNorm() - radius * radius;
  if (inside <= 0) return 0;
  const double root = along * along - inside;
  return along < 0 && root >= 0 ? -along - std::sqrt(root) : std::numeric_limits<double>::infinity();
}

void check_ray(const Vec3& origin, const Vec3& direction, double farthest) {
  Checks checks;
  checks.vector("origin", origin);
  checks.vector("direction", direction);
  if (direction.allFinite() && direction.isZero(0)) checks.problem("direction", "must not be 0");
  if (!(farthest >= 0)) checks.problem("farthest", "must be 0 or above");
  checks.finish();
}

}  // namespace

std::optional<BodyHit> Simulation::raycast(const Vec3& origin, const Vec3& direction, double farthest) const {
  const State& s = *state_;
  check_ray(origin, direction, farthest);
  const Vec from = origin.cast<double>() - s.origin.cast<double>(),
            along = direction.cast<double>().normalized();
  std::optional<BodyHit> hit;
  double nearest = farthest;
  for (const BodyState& body : s.bodies) {
    if (!body.enabled) continue;
    const double radius = k_ball_radius * static_cast<double>(body.spacing);
    for (std::size_t begin = body.begin; begin < body.end; begin += k_block) {
      const std::size_t end = std::min(body.end, begin + k_block);
      const Aabb box = box_around(s.store.position, begin, end);
      const Vec middle = 0.5 * (box.min + box.max).cast<double>();
      if (!(enter(from, along, middle, 0.5 * (box.max - box.min).cast<double>().norm() + radius) <= nearest))
        continue;
      for (std::size_t row = begin; row < end; ++row) {
        const Vec x = s.store.position.get(row).cast<double>();
        const double t = enter(from, along, x, radius);
        if (!(t <= nearest) || (t == nearest && hit) || std::isinf(t)) continue;
        nearest = t;
        const Vec normal = from + t * along - x;
        hit = BodyHit{
            .distance = t,
            .position = s.far((from + t * along).cast<float>()),
            .normal = Vec3((normal.norm() > 0 ? Vec(normal.normalized()) : Vec(-along)).cast<float>()),
            .body = body.id,
            .particle = s.store.id[row]};
      }
    }
  }
  return hit;
}

std::optional<ColliderHit> Simulation::raycast_colliders(const Vec3& origin, const Vec3& direction,
                                                         double farthest) const {
  const State& s = *state_;
  check_ray(origin, direction, farthest);
  const Vec along = direction.cast<double>().normalized();
  std::optional<ColliderHit> hit;
  double least = farthest;
  for (std::size_t c = 0; c < s.colliders.size(); ++c) {
    const Collider& collider = s.colliders[c];
    const Eigen::Matrix3d rotation = rotation_of(collider.pose);
    const Vec3 from =
        (rotation.transpose() * (origin.cast<double>() - collider.pose.translation)).cast<float>();
    const Vec3 way = (rotation.transpose() * along).cast<float>();
    visit_parts(collider, [&]<class Shape>(const Shape& shape) {
      for (const Crossing& crossing : ShapeTraits<Shape>::cross(shape, from, way)) {
        const double t = static_cast<double>(crossing.t);
        if (!(t >= 0 && t <= least) || std::isinf(t)) continue;
        // From the free side only.
        if (crossing.normal.dot(way) > 0) continue;
        least = t;
        hit = ColliderHit{.distance = t,
                          .position = (origin.cast<double>() + t * along).cast<float>(),
                          .normal = (rotation * crossing.normal.cast<double>()).cast<float>(),
                          .collider = ColliderId{s.collider_ids[c]}};
      }
    });
  }
  return hit;
}

std::vector<ParticleId> Simulation::particles_in(const Aabb& box) const {
  const State& s = *state_;
  Checks checks;
  if (!(box.min.array() <= box.max.array()).all()) checks.problem("box", "min must not be above max");
  checks.finish();
  std::vector<ParticleId> ids;
  for_rows_in(s, near_origin(s, box),
              [&](std::size_t row, const BodyState&) { ids.push_back(s.store.id[row]); });
  std::ranges::sort(ids);
  return ids;
}

std::vector<ParticleId> Simulation::particles_in(const Vec3& center, float radius) const {
  const State& s = *state_;
  Checks checks;
  checks.vector("center", center);
  checks.number("radius", static_cast<double>(radius), radius > 0, "a finite number above 0");
  checks.finish();
  const Vec3 middle = relative_to(s.origin, center), half = Vec3::Constant(radius);
  std::vector<ParticleId> ids;
  for_rows_in(s, {middle - half, middle + half}, [&](std::size_t row, const BodyState&) {
    if ((s.store.position.get(row) - middle).norm() <= radius) ids.push_back(s.store.id[row]);
  });
  std::ranges::sort(ids);
  return ids;
}

std::optional<NearestParticle> Simulation::nearest_particle(const Vec3& point) const {
  const State& s = *state_;
  Checks checks;
  checks.vector("point", point);
  checks.finish();
  const Vec from = point.cast<double>() - s.origin.cast<double>();
  std::optional<NearestParticle> nearest;
  for (const BodyState& body : s.bodies) {
    if (!body.enabled) continue;
    for (std::size_t row = body.begin; row < body.end; ++row) {
      const double distance = (s.store.position.get(row).cast<double>() - from).norm();
      const ParticleId id = s.store.id[row];
      if (nearest &&
          !(distance < nearest->distance || (distance == nearest->distance && id < nearest->particle)))
        continue;
      nearest = {.distance = distance, .particle = id, .body = body.id};
    }
  }
  return nearest;
}

Aabb Simulation::bounds(BodyId id) const {
  const State& s = *state_;
  const BodyState& body = s.body(id);
  const Aabb box = box_around(s.store.position, body.begin, body.end);
  return {s.far(box.min), s.far(box.max)};
}

BodyParts Simulation::parts(BodyId id) const {
  const BodyState& body = state_->body(id);
  mallow::prepare(*state_);
  if (!body.matches_shape() || !body.shape.built) return {};
  Parts parts;
  find_parts(body.shape, parts);
  return {parts.count, parts.crumbs};
}

BodyMotion Simulation::motion(BodyId id) const {
  const State& s = *state_;
  const BodyState& body = s.body(id);
  const Vec near = s.store.position.get(body.begin).cast<double>();
  const RigidSums sums =
      sum_rigid(s.execution.level, raw(s.store.position), raw(s.store.velocity), body.begin, body.end, near);
  const RigidMotion rigid = rigid_motion(sums, near);
  const double mass = static_cast<double>(body.mass);
  return {.mass = mass * sums.count,
          .center_of_mass = rigid.center + s.origin.cast<double>(),
          .velocity = rigid.velocity,
          .angular_velocity = rigid.spin,
          .momentum = mass * sums.velocity,
          .kinetic_energy = 0.5 * mass * sums.squared_speed};
}

std::vector<BodyId> Simulation::bodies() const {
  std::vector<BodyId> ids;
  for (const BodyState& body : state_->bodies) ids.push_back(body.id);
  return ids;
}

std::vector<ColliderId> Simulation::collider_ids() const {
  std::vector<ColliderId> ids;
  for (const std::uint64_t id : state_->collider_ids) ids.push_back(ColliderId{id});
  return ids;
}

std::optional<BodyId> Simulation::find_body(std::string_view name) const {
  State& s = *state_;
  if (!s.body_names.is_kept()) {
    s.body_names.keep();
    for (const BodyState& body : s.bodies) s.body_names.add(body);
  }
  const std::vector<BodyId>& ids = s.body_names.of(name);
  const auto place = [&](BodyId id) { return s.body_slots.index[slot_of(id)]; };
  const auto first = std::ranges::min_element(ids, {}, place);
  return first == ids.end() ? std::nullopt : std::optional(*first);
}

const std::string& Simulation::name(BodyId id) const {
  return std::as_const(*state_).body(id).name;
}

std::span<const BodyEvent> Simulation::events() const {
  return state_->events;
}

}  // namespace mallow

#include "motion/contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mallow {
namespace {

constexpr float k_infinity = std::numeric_limits<float>::infinity();

Vec3 vec(const float* v) {
  return {v[0], v[1], v[2]};
}

/// The first place on the way where the shape is near enough to be met, by steps as long as the shape is far:
/// none of them can pass through it.
template <class Shape>
SurfacePoint meet_from_outside(const Shape& shape, float contact_offset, const Vec3& x, const Vec3& way) {
  const float length = std::sqrt(way.squaredNorm());
  float t = 0;
  SurfacePoint met = nearest(shape, x);
  for (int look = 0; look < k_most_looks; ++look) {
    const float gap = met.distance - contact_offset;
    if (!(gap > k_near_enough * length)) break;
    t += gap / length;
    if (!(t < 1)) return {k_infinity, met.normal};
    met = nearest(shape, x + t * way);
  }
  return {met.distance - t * way.dot(met.normal), met.normal};
}

/// The normal velocity with which a particle leaves that comes with `approach`, so that it rises to e² of the
/// height that it fell from; minus infinity where it does not bounce.
float bounce(float restitution, float approach, float gap, const Vec3& normal, const ContactStep& step) {
  if (!(restitution > 0 && approach < -step.least_bounce)) return -k_infinity;
  const float gravity = std::max(0.0f, -vec(step.gravity).dot(normal));
  const float half_kick = 0.5f * gravity * step.time_step, speed = half_kick - approach;
  const float kept = restitution * restitution;
  const float square = kept * (speed * speed) - 2.0f * (1.0f - kept) * gravity * std::max(gap, 0.0f);
  return square > 0 ? std::min(std::sqrt(square) - half_kick, -approach) : -k_infinity;
}

/// A particle that meets the parts of a collider one after the other.
struct Meeting {
  const ContactSurface& surface;
  const ContactStep& step;
  const Vec3 &x, &before;
  Vec3 v;

  void operator()(const Plane& plane) { at(plane); }
  void operator()(const Sphere& sphere) { at(sphere); }
  void operator()(const Box& box) {
    if (!box.inside) return at(box);
    for (const Plane& face : faces(box)) at(face);
  }
  void operator()(const Union& shapes) {
    for (const Primitive& part : shapes.parts) std::visit(*this, part);
  }

 private:
  template <class Shape>
  void at(const Shape& shape) {
    const Vec3 way = step.time_step * (v - vec(surface.velocity));
    v = resolve_contact(surface, meet(shape, step.contact_offset, x, way), step, before, v);
  }
};

}  // namespace

ContactSurface contact_surface(const Collider& collider) {
  const Vec3& u = collider.velocity;
  return {{u[0], u[1], u[2]}, collider.restitution, collider.friction};
}

SurfacePoint meet(const Plane& plane, float, const Vec3& x, const Vec3&) {
  return nearest(plane, x);
}

SurfacePoint meet(const Sphere& sphere, float contact_offset, const Vec3& x, const Vec3& way) {
  if (!sphere.inside) return meet_from_outside(sphere, contact_offset, x, way);
  // A hollow is met where the way ends, not where the particle is: a fast one may cross it in one step.
  const SurfacePoint end = nearest(sphere, x + way);
  return {end.distance - way.dot(end.normal), end.normal};
}

SurfacePoint meet(const Box& box, float contact_offset, const Vec3& x, const Vec3& way) {
  return meet_from_outside(box, contact_offset, x, way);
}

std::array<Plane, 6> faces(const Box& box) {
  std::array<Plane, 6> planes;
  for (int axis = 0; axis < 3; ++axis) {
    planes[2 * static_cast<std::size_t>(axis)] = {Vec3::Unit(axis), box.min[axis]};
    planes[2 * static_cast<std::size_t>(axis) + 1] = {-Vec3::Unit(axis), -box.max[axis]};
  }
  return planes;
}

Vec3 resolve_contact(const ContactSurface& surface, const SurfacePoint& met, const ContactStep& step,
                     const Vec3& before, const Vec3& v) {
  const float gap = met.distance - step.contact_offset;
  const Vec3 &n = met.normal, u = vec(surface.velocity), relative = v - u;
  const float normal_velocity = relative.dot(n);
  if (gap + step.time_step * normal_velocity >= 0) return v;

  const Vec3 relative_before = before - u;
  const float approach = relative_before.dot(n);
  const float reach = -gap / step.time_step;  // just touches at the end of the step
  const float target = std::max(gap >= 0 ? reach : std::min(reach, step.max_push),
                                bounce(surface.restitution, approach, gap, n, step));
  const float change = target - normal_velocity;

  // Coulomb's friction takes at most what slides, and leaves what the step has turned round already.
  const Vec3 tangential = relative - normal_velocity * n, tangential_before = relative_before - approach * n;
  const float square = tangential.squaredNorm(), speed = std::sqrt(square);
  float taken = speed > 0 ? std::min(1.0f, surface.friction * change / speed) : 1.0f;
  const float along = tangential.dot(tangential_before);
  if (along < 0) taken = std::min(taken, std::max(0.0f, 1.0f + along / square));
  return u + target * n + (1.0f - taken) * tangential;
}

Vec3 resolve_contact(const Collider& collider, const ContactStep& step, const Vec3& x, const Vec3& before,
                     const Vec3& v) {
  const ContactSurface surface = contact_surface(collider);
  Meeting meeting{surface, step, x, before, v};
  std::visit(meeting, collider.shape);
  return meeting.v;
}

}  // namespace mallow

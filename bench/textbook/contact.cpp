#include "textbook/contact.h"

#include <algorithm>
#include <limits>
#include <variant>

namespace mallow::textbook {
namespace {

/// φ and n = ∇φ at a point.
struct Surface {
  double distance;
  Vec normal;
};

Surface kept_inside(bool inside, const Surface& s) {
  return inside ? Surface{-s.distance, -s.normal} : s;
}

Surface distance_to(const Plane& plane, const Vec& x) {
  const Vec normal = plane.normal.cast<double>();
  return {(normal.dot(x) - plane.offset) / normal.norm(), normal.normalized()};
}

Surface distance_to(const Sphere& sphere, const Vec& x) {
  const Vec d = x - sphere.center.cast<double>();
  const double r = d.norm();
  // Any direction will do at the centre.
  return kept_inside(sphere.inside, {r - sphere.radius, r > 0 ? Vec(d / r) : Vec::UnitZ()});
}

Surface distance_to(const Box& box, const Vec& x) {
  const Vec min = box.min.cast<double>(), max = box.max.cast<double>();
  const Vec outside = x - x.cwiseMax(min).cwiseMin(max);
  if (outside != Vec::Zero()) return kept_inside(box.inside, {outside.norm(), outside.normalized()});

  // The nearest of the six faces: both depths are negative here.
  Surface face{-std::numeric_limits<double>::infinity(), Vec::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    const double below = min[axis] - x[axis], above = x[axis] - max[axis];
    if (below > face.distance) face = {below, -Vec::Unit(axis)};
    if (above > face.distance) face = {above, Vec::Unit(axis)};
  }
  return kept_inside(box.inside, face);
}

Surface distance_to(const Union& shapes, const Vec& x) {
  Surface first{std::numeric_limits<double>::infinity(), Vec::Zero()};
  for (const Primitive& part : shapes.parts) {
    const Surface s = std::visit([&](const auto& shape) { return distance_to(shape, x); }, part);
    if (s.distance < first.distance) first = s;
  }
  return first;
}

}  // namespace

Vec resolve_contact(const Obstacle& obstacle, const ContactStep& step, const Vec& x, const Vec& v) {
  const Collider& collider = obstacle.collider;
  const auto [distance, normal] =
      std::visit([&](const auto& shape) { return distance_to(shape, x - obstacle.moved); }, collider.shape);
  const double gap = distance - step.contact_offset;
  const Vec surface_velocity = collider.velocity.cast<double>();
  const Vec relative = v - surface_velocity;
  const double normal_velocity = relative.dot(normal);
  if (gap + step.time_step * normal_velocity >= 0) return v;

  const double reach = -gap / step.time_step;  // just touches at the end of the step
  const double bounce = -collider.restitution * normal_velocity;
  const double target = std::max(gap >= 0 ? reach : std::min(reach, step.max_push), bounce);
  const Vec tangential = relative - normal_velocity * normal;
  const double sliding = tangential.norm();
  const double friction = collider.friction * (target - normal_velocity);
  const double kept = sliding > 0 ? std::max(0.0, 1 - friction / sliding) : 0;
  return surface_velocity + target * normal + kept * tangential;
}

}  // namespace mallow::textbook

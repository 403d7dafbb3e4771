#include "oracle/signed_distance.h"

#include <limits>

namespace mallow::oracle {
namespace {

using Vec = Eigen::Vector3d;

/// The same surface with free and solid side exchanged.
Distance turned_inside_out(const Distance& d) {
  return {-d.value, -d.normal};
}

Distance distance_outside_box(const Vec& min, const Vec& max, const Vec& x) {
  const Vec nearest = x.cwiseMax(min).cwiseMin(max);
  if (nearest != x) return {(x - nearest).norm(), (x - nearest).normalized()};

  Distance d{-std::numeric_limits<double>::infinity(), Vec::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    const double below = min[axis] - x[axis];
    const double above = x[axis] - max[axis];
    if (below > d.value) d = {below, -Vec::Unit(axis)};
    if (above > d.value) d = {above, Vec::Unit(axis)};
  }
  return d;
}

}  // namespace

Distance distance(const Plane& plane, const Vec& x) {
  const Vec normal = plane.normal.cast<double>();
  return {(normal.dot(x) - plane.offset) / normal.norm(), normal.normalized()};
}

Distance distance(const Sphere& sphere, const Vec& x) {
  const Vec from_center = x - sphere.center.cast<double>();
  const double r = from_center.norm();
  const Distance d{r - sphere.radius, r > 0 ? Vec(from_center / r) : Vec::UnitZ()};
  return sphere.inside ? turned_inside_out(d) : d;
}

Distance distance(const Box& box, const Vec& x) {
  const Distance d = distance_outside_box(box.min.cast<double>(), box.max.cast<double>(), x);
  return box.inside ? turned_inside_out(d) : d;
}

Distance distance(const Union& shapes, const Vec& x) {
  Distance nearest{std::numeric_limits<double>::infinity(), Vec::Zero()};
  for (const Primitive& part : shapes.parts) {
    const Distance d = std::visit([&](const auto& shape) { return distance(shape, x); }, part);
    if (d.value < nearest.value) nearest = d;
  }
  return nearest;
}

Distance distance(const Collider& collider, const Vec& x) {
  return std::visit([&](const auto& shape) { return distance(shape, x); }, collider.shape);
}

}  // namespace mallow::oracle

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

Distance distance(const Primitive& shape, const Vec& x) {
  return std::visit([&](const auto& one) { return distance(one, x); }, shape);
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

std::vector<Primitive> parts_of(const Collider& collider) {
  std::vector<Primitive> shapes, parts;
  if (const auto* all = std::get_if<Union>(&collider.shape)) shapes = all->parts;
  if (const auto* one = std::get_if<Plane>(&collider.shape)) shapes = {*one};
  if (const auto* one = std::get_if<Sphere>(&collider.shape)) shapes = {*one};
  if (const auto* one = std::get_if<Box>(&collider.shape)) shapes = {*one};
  for (const Primitive& shape : shapes) {
    const Box* const box = std::get_if<Box>(&shape);
    if (!box || !box->inside) {
      parts.push_back(shape);
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) {
      parts.push_back(Plane{Vec3::Unit(axis), box->min[axis]});
      parts.push_back(Plane{-Vec3::Unit(axis), -box->max[axis]});
    }
  }
  return parts;
}

Distance distance_on_the_way(const Primitive& part, const Vec& x, const Vec& way, double contact_offset) {
  if (std::holds_alternative<Plane>(part)) return distance(part, x);
  const Sphere* const sphere = std::get_if<Sphere>(&part);
  if (sphere && sphere->inside) {
    const Distance end = distance(part, x + way);
    return {end.value - way.dot(end.normal), end.normal};
  }
  // Sixteen steps along the way at most, each as long as the gap, while that is more than a 64th of the way.
  double t = 0;
  Distance d = distance(part, x);
  for (int k = 0; k < 16 && d.value - contact_offset > way.norm() / 64; ++k) {
    t += (d.value - contact_offset) / way.norm();
    if (t >= 1) return {std::numeric_limits<double>::infinity(), d.normal};
    d = distance(part, x + t * way);
  }
  return {d.value - t * way.dot(d.normal), d.normal};
}

}  // namespace mallow::oracle

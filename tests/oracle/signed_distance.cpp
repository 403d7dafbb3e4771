#include "oracle/signed_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "colliders/hull.h"

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

/// The foot of p on the straight line from a to b.
Vec foot_on_segment(const Vec& a, const Vec& b, const Vec& p) {
  const double share = (p - a).dot(b - a) / (b - a).squaredNorm();
  return a + std::min(1.0, std::max(0.0, share)) * (b - a);
}

/// The point of a triangle that is nearest to p.
Vec foot_on_triangle(const Vec& a, const Vec& b, const Vec& c, const Vec& p) {
  const Vec n = (b - a).cross(c - a).normalized();
  const Vec in_plane = p - n.dot(p - a) * n;
  bool within = true;
  Vec best = a;
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    within = within && (to - from).cross(in_plane - from).dot(n) >= 0;
    const Vec foot = foot_on_segment(from, to, p);
    if ((p - foot).norm() < (p - best).norm()) best = foot;
  }
  return within ? in_plane : best;
}

/// Any direction across a.
Vec across(const Vec& a) {
  const Vec one = a.cross(Vec::UnitX());
  return (one.norm() > 0.1 * a.norm() ? one : a.cross(Vec::UnitY())).normalized();
}

/// The axis and the outline of a cone in the half plane of it and x: out to the start radius, along the side
/// and back to the axis. The nearest point of the outline counts.
Distance distance_outside_cone(const Cone& cone, const Vec& x) {
  const Vec start = cone.start.cast<double>(), end = cone.end.cast<double>(),
            axis = (end - start).normalized();
  Vec out = x - start - (x - start).dot(axis) * axis;
  out = out.norm() > 0 ? out.normalized() : across(axis);
  const Vec rim = start + cone.start_radius * out, other_rim = end + cone.end_radius * out;
  Vec foot = foot_on_segment(rim, other_rim, x);
  for (const auto& [middle, edge] : {std::pair(start, rim), std::pair(end, other_rim)}) {
    if (edge == middle) continue;
    const Vec other = foot_on_segment(middle, edge, x);
    if ((x - other).norm() < (x - foot).norm()) foot = other;
  }
  const double height = (x - start).dot(axis), share = height / (end - start).norm();
  const double radius = cone.start_radius + share * (cone.end_radius - cone.start_radius);
  const bool in = share > 0 && share < 1 && (x - start - height * axis).norm() < radius;
  const Distance d{(x - foot).norm(), (x - foot).normalized()};
  return in ? turned_inside_out(d) : d;
}

/// The planes at the ends of an axis, free in between.
void add_ends(const Vec3& start, const Vec3& end, std::vector<Primitive>& parts) {
  const Vec axis = (end.cast<double>() - start.cast<double>()).normalized();
  parts.push_back(Plane{axis.cast<float>(), static_cast<float>(axis.dot(start.cast<double>()))});
  parts.push_back(Plane{(-axis).cast<float>(), static_cast<float>(-axis.dot(end.cast<double>()))});
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

Distance distance(const Capsule& capsule, const Vec& x) {
  const Vec start = capsule.start.cast<double>(), end = capsule.end.cast<double>();
  const Vec from_axis = x - foot_on_segment(start, end, x);
  const double r = from_axis.norm();
  const Distance d{r - capsule.radius, r > 0 ? Vec(from_axis / r) : across(end - start)};
  return capsule.inside ? turned_inside_out(d) : d;
}

Distance distance(const Cylinder& c, const Vec& x) {
  return distance(Cone{c.start, c.end, c.radius, c.radius, c.inside}, x);
}

Distance distance(const Cone& cone, const Vec& x) {
  const Distance d = distance_outside_cone(cone, x);
  return cone.inside ? turned_inside_out(d) : d;
}

Distance distance(const ConvexHull& hull, const Vec& x) {
  std::vector<Vec> corners;
  for (const Vec3& corner : hull.data->corners) corners.push_back(corner.cast<double>());
  // Inside, the nearest of the planes that have all corners behind them; outside, the nearest triangle.
  Distance in{-std::numeric_limits<double>::infinity(), Vec::Zero()};
  Distance out{std::numeric_limits<double>::infinity(), Vec::Zero()};
  for (const Vec& a : corners)
    for (const Vec& b : corners)
      for (const Vec& c : corners) {
        const Vec cross = (b - a).cross(c - a);
        if (&a == &b || cross.norm() < 1e-9) continue;
        const Vec n = cross.normalized();
        const bool is_outermost =
            std::all_of(corners.begin(), corners.end(), [&](const Vec& p) { return n.dot(p - a) < 1e-6; });
        if (!is_outermost) continue;
        const double d = n.dot(x - a);
        if (d > in.value) in = {d, n};
        const Vec foot = foot_on_triangle(a, b, c, x);
        if ((x - foot).norm() < out.value) out = {(x - foot).norm(), (x - foot).normalized()};
      }
  const Distance d = in.value > 0 ? out : in;
  return hull.inside ? turned_inside_out(d) : d;
}

Distance distance(const DistanceField& field, const Vec& x) {
  const DistanceGrid& grid = *field.grid;
  const double voxel = static_cast<double>(grid.voxel_size);
  const Vec at = (x - grid.origin.cast<double>()) / voxel;
  Vec held, share;
  std::array<int, 3> cell{};
  for (int axis = 0; axis < 3; ++axis) {
    const int last = grid.size[static_cast<std::size_t>(axis)] - 1;
    held[axis] = std::clamp(at[axis], 0.0, static_cast<double>(last));
    cell[static_cast<std::size_t>(axis)] = std::min(static_cast<int>(held[axis]), last - 1);
    share[axis] = held[axis] - cell[static_cast<std::size_t>(axis)];
  }
  double value = 0;
  Vec gradient = Vec::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    double weight[3], slope[3];
    std::size_t i = 0, stride = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const int up = corner >> axis & 1;
      weight[axis] = up == 1 ? share[axis] : 1 - share[axis];
      slope[axis] = up == 1 ? 1 : -1;
      i += stride * static_cast<std::size_t>(cell[static_cast<std::size_t>(axis)] + up);
      stride *= static_cast<std::size_t>(grid.size[static_cast<std::size_t>(axis)]);
    }
    const double d = static_cast<double>(grid.distances[i]);
    value += weight[0] * weight[1] * weight[2] * d;
    gradient += d * Vec(slope[0] * weight[1] * weight[2], weight[0] * slope[1] * weight[2],
                        weight[0] * weight[1] * slope[2]);
  }
  Distance d{value, gradient.norm() > 0 ? Vec(gradient.normalized()) : Vec::UnitZ()};
  if (const Vec beside = voxel * (at - held); beside != Vec::Zero())
    d = {std::hypot(beside.norm(), value), (beside + value * d.normal).normalized()};
  return field.inside ? turned_inside_out(d) : d;
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
  visit_parts(collider, [&](const auto& shape) { shapes.push_back(shape); });
  for (const Primitive& shape : shapes) {
    const Box* const box = std::get_if<Box>(&shape);
    if (const Cone* const cone = std::get_if<Cone>(&shape); cone && cone->inside)
      add_ends(cone->start, cone->end, parts);
    if (const Cylinder* const cylinder = std::get_if<Cylinder>(&shape); cylinder && cylinder->inside)
      add_ends(cylinder->start, cylinder->end, parts);
    if (const ConvexHull* const hull = std::get_if<ConvexHull>(&shape); hull && hull->inside) {
      for (const auto& [x, y, z, offset] : hull->data->planes) parts.push_back(Plane{{-x, -y, -z}, -offset});
      continue;
    }
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
  const auto keeps_in = []<class Shape>(const Shape& shape) {
    if constexpr (std::is_same_v<Shape, DistanceField>) return false;  // which is no hollow that is convex
    if constexpr (requires { shape.inside; }) return shape.inside;
    return false;
  };
  if (std::visit(keeps_in, part)) {
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

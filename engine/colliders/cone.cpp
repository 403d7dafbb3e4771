#include "colliders/cone.h"

#include <algorithm>
#include <cmath>

#include "colliders/axis.h"

namespace mallow {

MALLOW_DECLARE_LEVELS(ColliderLanes, cone_lanes)

namespace {

/// In the half plane of radius and height: the side goes from (start_radius, 0) to (end_radius, length).
struct Side {
  double length;
  double outwards, upwards;  ///< its unit normal
};

Side side_of(const Cone& cone, const Axis& axis) {
  const double narrowing = static_cast<double>(cone.start_radius) - static_cast<double>(cone.end_radius);
  const double length = std::hypot(axis.length, narrowing);
  return {length, axis.length / length, narrowing / length};
}

/// Where a line between the ends of a cone is within its side: a t² + 2 b t + c <= 0, as |across| is at most
/// the radius there.
Stretch stretch_within_side(const Cone& cone, const Axis& axis, const LineAtAxis& line) {
  const double taper =
      (static_cast<double>(cone.end_radius) - static_cast<double>(cone.start_radius)) / axis.length;
  const double radius = static_cast<double>(cone.start_radius) + taper * line.height;
  const double growth = taper * line.climb;
  if (growth == 0) return stretch_within(line.across, line.slide, std::max(radius, 0.0));
  const double a = line.slide.squaredNorm() - growth * growth;
  const double b = line.across.dot(line.slide) - radius * growth;
  const double c = line.across.squaredNorm() - radius * radius;
  const double square = b * b - a * c;
  if (square < 0) return a > 0 ? Stretch::none() : Stretch{};
  const double q = -(b + std::copysign(std::sqrt(square), b));
  if (q == 0) return Stretch::none();
  const double one = q / a, other = c / q;
  if (a > 0) return {std::min(one, other), std::max(one, other)};
  // The cone has a twin behind its tip: the line is in this one on the side where radii grow.
  const double bound = a == 0 ? other : growth > 0 ? std::max(one, other) : std::min(one, other);
  return growth > 0 ? Stretch{.first = bound} : Stretch{.last = bound};
}

}  // namespace

const ColliderLanes& ShapeTraits<Cone>::lanes(InstructionLevel level) {
  return MALLOW_SELECT(level, cone_lanes);
}

std::optional<ShapeProblem> ShapeTraits<Cone>::problem(const Cone& cone) {
  if (!(cone.start_radius > 0 || cone.end_radius > 0))
    return ShapeProblem{"start_radius", "above 0 where end_radius is 0"};
  return axis_problem(cone.start, cone.end);
}

Plane ShapeTraits<Cone>::end_plane(const Vec3& at, const Vec3& other) {
  const Axis axis = axis_of(at, other);
  return {axis.direction.cast<float>(), static_cast<float>(axis.direction.dot(axis.start))};
}

ShapeNumbers ShapeTraits<Cone>::numbers(const Cone& cone, const Eigen::Vector3d& by) {
  const Axis axis = axis_of(cone.start, cone.end);
  const Side side = side_of(cone, axis);
  const Vec3 start = (axis.start + by).cast<float>(), direction = axis.direction.cast<float>();
  return {
      {start[0], start[1], start[2], direction[0], direction[1], direction[2],
       static_cast<float>(axis.length), cone.start_radius, cone.end_radius, static_cast<float>(side.outwards),
       static_cast<float>(side.upwards), static_cast<float>(side.length)},
      cone.inside};
}

Crossings ShapeTraits<Cone>::cross(const Cone& cone, const Vec3& origin, const Vec3& direction) {
  const Axis axis = axis_of(cone.start, cone.end);
  const Side side = side_of(cone, axis);
  const LineAtAxis line(axis, origin, direction);
  const Stretch between = stretch_between(line.height, line.climb, 0, axis.length);
  const Stretch within = stretch_within_side(cone, axis, line);
  const Stretch in = common(between, within);
  if (in.is_empty()) return {};
  const double sign = cone.inside ? -1 : 1;
  // enters: through an end against the axis where the line climbs.
  const auto at = [&](double t, bool through_side, bool enters) {
    const Eigen::Vector3d across = line.across + t * line.slide;
    const double along = (line.climb > 0) == enters ? -1 : 1;
    Eigen::Vector3d normal = along * axis.direction;
    if (through_side) normal = side.outwards * across.normalized() + side.upwards * axis.direction;
    return Crossing{static_cast<float>(t), (sign * normal).cast<float>()};
  };
  return {at(in.first, within.first >= between.first, true), at(in.last, within.last <= between.last, false)};
}

float ShapeTraits<Cone>::edge_distance(const Cone& cone, const Vec3& x) {
  const Axis axis = axis_of(cone.start, cone.end);
  const LineAtAxis point(axis, x, {0, 0, 0});
  const double radius = point.across.norm();
  return static_cast<float>(
      std::min(std::hypot(radius - static_cast<double>(cone.start_radius), point.height),
               std::hypot(radius - static_cast<double>(cone.end_radius), point.height - axis.length)));
}

Aabb bounds(const Cone& cone) {
  const Axis axis = axis_of(cone.start, cone.end);
  // How far a disc across the axis reaches along each axis of the frame, in radii.
  const Vec3 reach = (1 - axis.direction.array().square()).max(0).sqrt().matrix().cast<float>();
  const Vec3 start_reach = cone.start_radius * reach, end_reach = cone.end_radius * reach;
  return {(cone.start - start_reach).cwiseMin(cone.end - end_reach),
          (cone.start + start_reach).cwiseMax(cone.end + end_reach)};
}

}  // namespace mallow

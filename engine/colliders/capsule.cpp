#include "colliders/capsule.h"

#include <algorithm>
#include <cmath>

#include "colliders/axis.h"

namespace mallow {

MALLOW_DECLARE_LEVELS(ColliderLanes, capsule_lanes)

const ColliderLanes& ShapeTraits<Capsule>::lanes(InstructionLevel level) {
  return MALLOW_SELECT(level, capsule_lanes);
}

std::optional<ShapeProblem> ShapeTraits<Capsule>::problem(const Capsule& capsule) {
  return axis_problem(capsule.start, capsule.end);
}

ShapeNumbers ShapeTraits<Capsule>::numbers(const Capsule& capsule, const Eigen::Vector3d& by) {
  const Axis axis = axis_of(capsule.start, capsule.end);
  const Vec3 start = (axis.start + by).cast<float>(), direction = axis.direction.cast<float>();
  return {{start[0], start[1], start[2], direction[0], direction[1], direction[2],
           static_cast<float>(axis.length), capsule.radius},
          capsule.inside};
}

Crossings ShapeTraits<Capsule>::cross(const Capsule& capsule, const Vec3& origin, const Vec3& direction) {
  const Axis axis = axis_of(capsule.start, capsule.end);
  const LineAtAxis line(axis, origin, direction);
  const double radius = static_cast<double>(capsule.radius);
  const auto in_ball = [&](double along) {
    return stretch_within(line.across + (line.height - along) * axis.direction,
                          line.slide + line.climb * axis.direction, radius);
  };
  // It is convex, and two balls and the cylinder between: in from the first that is entered to the last.
  Stretch in = Stretch{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Stretch& part : {in_ball(0), in_ball(axis.length),
                              common(stretch_between(line.height, line.climb, 0, axis.length),
                                     stretch_within(line.across, line.slide, radius))})
    if (!part.is_empty()) in = {std::min(in.first, part.first), std::max(in.last, part.last)};
  if (in.is_empty()) return {};
  const auto at = [&](double t) {
    const double height = line.height + t * line.climb;
    const double beyond = height - std::clamp(height, 0.0, axis.length);
    const Eigen::Vector3d normal = (line.across + t * line.slide + beyond * axis.direction).normalized();
    return Crossing{static_cast<float>(t), (capsule.inside ? -normal : normal).cast<float>()};
  };
  return {at(in.first), at(in.last)};
}

Aabb bounds(const Capsule& capsule) {
  const Vec3 radius = Vec3::Constant(capsule.radius);
  return {capsule.start.cwiseMin(capsule.end) - radius, capsule.start.cwiseMax(capsule.end) + radius};
}

}  // namespace mallow

#include "colliders/plane.h"

#include "colliders/pose.h"

namespace mallow {

MALLOW_DECLARE_LEVELS(ColliderLanes, plane_lanes)

namespace {

Plane normalized(const Plane& plane) {
  const float length = plane.normal.norm();
  return {plane.normal / length, plane.offset / length};
}

}  // namespace

const ColliderLanes& ShapeTraits<Plane>::lanes(InstructionLevel level) {
  return MALLOW_SELECT(level, plane_lanes);
}

std::optional<ShapeProblem> ShapeTraits<Plane>::problem(const Plane& plane) {
  // Outside these lengths the square of the normal leaves single precision, and its direction is lost.
  const float length = plane.normal.stableNorm();
  if (length >= 1e-15f && length <= 1e15f) return std::nullopt;
  return ShapeProblem{"normal", "a direction, of length in [1e-15, 1e15]"};
}

ShapeNumbers ShapeTraits<Plane>::numbers(const Plane& plane, const Eigen::Vector3d& by) {
  const Plane unit = normalized(plane);
  const double offset = static_cast<double>(unit.offset) + unit.normal.cast<double>().dot(by);
  // Once more, so that the length is 1 to the last bit but one.
  const float length = unit.normal.stableNorm();
  const Vec3 normal = unit.normal / length;
  return {{normal[0], normal[1], normal[2], static_cast<float>(offset) / length}, false};
}

Crossings ShapeTraits<Plane>::cross(const Plane& plane, const Vec3& origin, const Vec3& direction) {
  const Plane unit = normalized(plane);
  const float speed = unit.normal.dot(direction);
  if (speed == 0) return {};
  return {Crossing{(unit.offset - unit.normal.dot(origin)) / speed, unit.normal}, Crossing{}};
}

Aabb bounds(const Plane& plane) {
  constexpr float k_far = std::numeric_limits<float>::infinity();
  Aabb box{Vec3::Constant(-k_far), Vec3::Constant(k_far)};
  // Flat along an axis that the normal lies in.
  for (int axis = 0; axis < 3; ++axis) {
    if (plane.normal != Vec3(plane.normal[axis] * Vec3::Unit(axis))) continue;
    box.min[axis] = box.max[axis] = plane.offset / plane.normal[axis];
  }
  return box;
}

Plane placed(const Plane& plane, const Pose& pose) {
  const Plane unit = normalized(plane);
  const Eigen::Vector3d normal = rotation_of(pose) * unit.normal.cast<double>();
  return {normal.cast<float>(),
          static_cast<float>(static_cast<double>(unit.offset) + normal.dot(pose.translation))};
}

}  // namespace mallow

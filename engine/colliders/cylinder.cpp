#include "colliders/cylinder.h"

#include "colliders/axis.h"

namespace mallow {

const ColliderLanes& ShapeTraits<Cylinder>::lanes(InstructionLevel level) {
  return ShapeTraits<Cone>::lanes(level);
}

std::optional<ShapeProblem> ShapeTraits<Cylinder>::problem(const Cylinder& cylinder) {
  return axis_problem(cylinder.start, cylinder.end);
}

ShapeNumbers ShapeTraits<Cylinder>::numbers(const Cylinder& cylinder, const Eigen::Vector3d& by) {
  return ShapeTraits<Cone>::numbers(as_cone(cylinder), by);
}

Crossings ShapeTraits<Cylinder>::cross(const Cylinder& cylinder, const Vec3& origin, const Vec3& direction) {
  return ShapeTraits<Cone>::cross(as_cone(cylinder), origin, direction);
}

float ShapeTraits<Cylinder>::edge_distance(const Cylinder& cylinder, const Vec3& x) {
  return ShapeTraits<Cone>::edge_distance(as_cone(cylinder), x);
}

Aabb bounds(const Cylinder& cylinder) {
  return bounds(Cone{cylinder.start, cylinder.end, cylinder.radius, cylinder.radius});
}

}  // namespace mallow

#include "colliders/sphere.h"

#include <cmath>

namespace mallow {

MALLOW_DECLARE_LEVELS(ColliderLanes, sphere_lanes)

const ColliderLanes& ShapeTraits<Sphere>::lanes(InstructionLevel level) {
  return MALLOW_SELECT(level, sphere_lanes);
}

ShapeNumbers ShapeTraits<Sphere>::numbers(const Sphere& sphere, const Eigen::Vector3d& by) {
  const Vec3 center = (sphere.center.cast<double>() + by).cast<float>();
  return {{center[0], center[1], center[2], sphere.radius}, sphere.inside};
}

Crossings ShapeTraits<Sphere>::cross(const Sphere& sphere, const Vec3& origin, const Vec3& direction) {
  const Vec3 to_center = sphere.center - origin;
  const float middle = to_center.dot(direction);
  // From the nearest point of the line rather than from b² - 4ac, which cancels far from the sphere.
  const Vec3 offset = to_center - middle * direction;
  const float half_squared = sphere.radius * sphere.radius - offset.squaredNorm();
  if (half_squared <= 0) return {};
  const float half = std::sqrt(half_squared);
  const float side = sphere.inside ? -1.0f : 1.0f;
  const auto at = [&](float t) {
    return Crossing{t, side * (origin + t * direction - sphere.center).normalized()};
  };
  return {at(middle - half), at(middle + half)};
}

Aabb bounds(const Sphere& sphere) {
  const Vec3 radius = Vec3::Constant(sphere.radius);
  return {sphere.center - radius, sphere.center + radius};
}

}  // namespace mallow

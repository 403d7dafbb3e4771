#include "colliders/pose.h"
#include "colliders/shapes.h"

namespace mallow {
namespace {

/// By the lanes, which know no other way for one point than for many.
template <class Shape>
SurfacePoint nearest_of_one(const Shape& shape, const Vec3& x) {
  SurfacePoint point;
  const ShapeNumbers numbers = ShapeTraits<Shape>::numbers(shape, {0, 0, 0});
  ShapeTraits<Shape>::lanes(InstructionLevel::baseline)
      .nearest(numbers, {&x[0], &x[1], &x[2]}, 0, 1, &point.distance,
               {&point.normal[0], &point.normal[1], &point.normal[2]});
  return point;
}

}  // namespace

SurfacePoint nearest(const Plane& plane, const Vec3& x) {
  return nearest_of_one(plane, x);
}
SurfacePoint nearest(const Sphere& sphere, const Vec3& x) {
  return nearest_of_one(sphere, x);
}
SurfacePoint nearest(const Box& box, const Vec3& x) {
  return nearest_of_one(box, x);
}
SurfacePoint nearest(const Capsule& capsule, const Vec3& x) {
  return nearest_of_one(capsule, x);
}
SurfacePoint nearest(const Cylinder& cylinder, const Vec3& x) {
  return nearest_of_one(cylinder, x);
}
SurfacePoint nearest(const Cone& cone, const Vec3& x) {
  return nearest_of_one(cone, x);
}
SurfacePoint nearest(const ConvexHull& hull, const Vec3& x) {
  return nearest_of_one(hull, x);
}
SurfacePoint nearest(const DistanceField& field, const Vec3& x) {
  return nearest_of_one(field, x);
}

SurfacePoint nearest(const Union& shapes, const Vec3& x) {
  SurfacePoint best{std::numeric_limits<float>::infinity(), Vec3::UnitZ()};
  for (const Primitive& part : shapes.parts) {
    const SurfacePoint point = std::visit([&](const auto& shape) { return nearest(shape, x); }, part);
    if (point.distance < best.distance) best = point;
  }
  return best;
}

SurfacePoint nearest(const Collider& collider, const Vec3& x) {
  const Eigen::Matrix3d rotation = rotation_of(collider.pose);
  const Vec3 own = (rotation.transpose() * (x.cast<double>() - collider.pose.translation)).cast<float>();
  const SurfacePoint point =
      std::visit([&](const auto& shape) { return nearest(shape, own); }, collider.shape);
  return {point.distance, rotation.cast<float>() * point.normal};
}

}  // namespace mallow

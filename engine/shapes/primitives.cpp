#include "shapes/primitives.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "shapes/norm_range.h"

namespace mallow {
namespace {

constexpr float k_no_length = std::numeric_limits<float>::min();

/// |v|, also where a float does not hold the square of it.
float norm(const Vec3& v) {
  const float square = v.squaredNorm();
  return square > k_least_square && square < k_greatest_square ? std::sqrt(square) : v.stableNorm();
}

/// Seen from the other side: what was inside is outside.
SurfacePoint turned(const SurfacePoint& point) {
  return {-point.distance, -point.normal};
}

}  // namespace

SurfacePoint nearest(const Plane& plane, const Vec3& x) {
  const float length = plane.normal.stableNorm();
  const Vec3 normal = plane.normal / length;
  return {normal.dot(x) - plane.offset / length, normal};
}

SurfacePoint nearest(const Sphere& sphere, const Vec3& x) {
  const Vec3 offset = x - sphere.center;
  const float length = norm(offset);
  const Vec3 normal = length > k_no_length ? Vec3(offset / length) : Vec3::UnitZ();
  const SurfacePoint point{length - sphere.radius, normal};
  return sphere.inside ? turned(point) : point;
}

SurfacePoint nearest(const Box& box, const Vec3& x) {
  const Vec3 below = box.min - x;
  const Vec3 above = x - box.max;
  const Vec3 outside = above.cwiseMax(0.0f) - below.cwiseMax(0.0f);
  const float length = norm(outside);
  SurfacePoint point;
  if (length > k_no_length) {
    point = {length, outside / length};
  } else {
    // On or in the box the nearest face counts. The axes are tried from z down, so that z wins a tie.
    point = {-std::numeric_limits<float>::infinity(), Vec3::UnitZ()};
    for (int axis : {2, 1, 0}) {
      if (above[axis] > point.distance) point = {above[axis], Vec3::Unit(axis)};
      if (below[axis] > point.distance) point = {below[axis], -Vec3::Unit(axis)};
    }
  }
  return box.inside ? turned(point) : point;
}

SurfacePoint nearest(const Union& shapes, const Vec3& x) {
  SurfacePoint best{std::numeric_limits<float>::infinity(), Vec3::UnitZ()};
  for (const Primitive& part : shapes.parts) {
    const SurfacePoint point = std::visit([&](const auto& shape) { return nearest(shape, x); }, part);
    if (point.distance < best.distance) best = point;
  }
  return best;
}

float sphere_distance(const Vec3& x, const Vec3& center, float radius) {
  return (x - center).norm() - radius;
}

float rounded_box_distance(const Vec3& x, const Vec3& center, const Vec3& half, float rounding) {
  const Vec3 beyond = (x - center).cwiseAbs() - (half - Vec3::Constant(rounding));
  return beyond.cwiseMax(0.0f).norm() + std::min(beyond.maxCoeff(), 0.0f) - rounding;
}

float capsule_distance(const Vec3& x, const Vec3& a, const Vec3& b, float radius) {
  const Vec3 axis = b - a;
  const float along = std::clamp((x - a).dot(axis) / axis.squaredNorm(), 0.0f, 1.0f);
  return (x - a - along * axis).norm() - radius;
}

// The nearest point is y_i = r_i² x_i / (t + r_i²) with the root t > −min r² of F(t) = Σ (r_i x_i / (t +
// r_i²))² − 1 (Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid"). F is convex
// and falls, so Newton's steps from the left of the root never pass it; at the start used here F is at most
// 2, so few are needed.
float ellipsoid_distance(const Vec3& x, const Vec3& center, const Vec3& radii) {
  // On a plane of symmetry the root may vanish; a step of 1e-6 aside brings it back and cannot be seen in the
  // result.
  const Eigen::Array3d r = radii.cast<double>().array();
  const Eigen::Array3d p = (x - center).cast<double>().array().abs().max(1e-6 * r);
  const Eigen::Array3d r2 = r.square();
  double t = (r * p - r2).maxCoeff();
  for (int step = 0; step < 12; ++step) {
    const Eigen::Array3d inverse = (t + r2).inverse();
    const Eigen::Array3d square = (r * p * inverse).square();
    const double value = square.sum() - 1.0;
    if (value < 1e-7) break;
    t += value / (2.0 * (square * inverse).sum());
  }
  const double distance = (p * t / (t + r2)).matrix().norm();
  return static_cast<float>(t < 0.0 ? -distance : distance);
}

float smooth_union(float a, float b, float blend) {
  const float overlap = std::max(blend - std::abs(a - b), 0.0f);
  return std::min(a, b) - overlap * overlap / (4.0f * blend);
}

float smooth_subtraction(float a, float b, float blend) {
  return -smooth_union(-a, b, blend);
}

float smooth_intersection(float a, float b, float blend) {
  return -smooth_union(-a, -b, blend);
}

}  // namespace mallow

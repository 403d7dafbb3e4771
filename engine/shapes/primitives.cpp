#include "shapes/primitives.h"

#include <algorithm>
#include <cmath>

namespace mallow {

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

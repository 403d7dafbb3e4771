#include <algorithm>
#include <cmath>

#include "mallow/body.h"
#include "shapes/primitives.h"

/// A head like those of Rapa Nui. Lengths are in the shape's own units: x forward, y to the side, z up. The
/// head is symmetric, so all of it is written for y >= 0.
namespace mallow {
namespace {

/// Distance to the half space below the plane through `point` with the outward normal `normal`.
float below_plane(const Vec3& x, const Vec3& point, const Vec3& normal) {
  return (x - point).dot(normal.normalized());
}

/// Skull and neck: a block whose sides close in and whose forehead leans back towards the flat top.
float head(const Vec3& x) {
  float block = rounded_box_distance(x, {-1.5f, 0.0f, 23.5f}, {7.2f, 7.4f, 16.5f}, 1.8f);
  block = smooth_intersection(block, below_plane(x, {0.0f, 7.2f, 14.0f}, {0.0f, 1.0f, 0.035f}), 2.0f);
  block = smooth_intersection(block, below_plane(x, {5.3f, 0.0f, 31.0f}, {1.0f, 0.0f, 0.22f}), 2.0f);
  block = smooth_intersection(block, below_plane(x, {-8.0f, 0.0f, 18.0f}, {-1.0f, 0.0f, 0.09f}), 3.0f);
  const float neck = rounded_box_distance(x, {-2.2f, 0.0f, 4.0f}, {5.9f, 6.3f, 8.0f}, 2.5f);
  return smooth_union(block, neck, 3.0f);
}

float jaw(const Vec3& x) {
  const float chin = rounded_box_distance(x, {4.2f, 0.0f, 8.2f}, {4.6f, 4.3f, 2.6f}, 1.5f);
  const float side = capsule_distance(x, {5.0f, 3.6f, 8.8f}, {-2.5f, 5.7f, 12.5f}, 1.9f);
  return smooth_union(chin, side, 2.5f);
}

float brow(const Vec3& x) {
  return capsule_distance(x, {6.8f, 0.0f, 32.2f}, {5.2f, 5.4f, 31.8f}, 1.8f);
}

float socket(const Vec3& x) {
  return ellipsoid_distance(x, {6.6f, 4.2f, 27.6f}, {4.4f, 2.6f, 3.0f});
}

float nose(const Vec3& x) {
  const float ridge = capsule_distance(x, {6.4f, 0.0f, 31.0f}, {10.2f, 0.0f, 20.8f}, 1.4f);
  const float root = capsule_distance(x, {4.8f, 0.0f, 30.0f}, {7.2f, 0.0f, 20.6f}, 2.0f);
  const float wing = ellipsoid_distance(x, {7.6f, 2.3f, 20.2f}, {2.8f, 1.7f, 1.8f});
  const float nostril = sphere_distance(x, {9.3f, 1.6f, 18.6f}, 0.8f);
  return smooth_subtraction(smooth_union(smooth_union(ridge, root, 1.5f), wing, 1.2f), nostril, 0.4f);
}

float lips(const Vec3& x) {
  const float muzzle = ellipsoid_distance(x, {4.6f, 0.0f, 14.4f}, {3.2f, 5.2f, 4.2f});
  const float upper = capsule_distance(x, {8.4f, 0.0f, 16.1f}, {6.6f, 3.6f, 15.5f}, 1.15f);
  const float lower = capsule_distance(x, {8.2f, 0.0f, 13.1f}, {6.5f, 3.4f, 13.1f}, 1.15f);
  return smooth_union(muzzle, std::min(upper, lower), 0.8f);
}

float ear(const Vec3& x) {
  const float plate = rounded_box_distance(x, {-1.8f, 6.8f, 23.0f}, {1.9f, 1.7f, 7.5f}, 1.2f);
  const float lobe = ellipsoid_distance(x, {-1.4f, 7.2f, 15.5f}, {2.2f, 1.4f, 3.4f});
  const float hollow = ellipsoid_distance(x, {-1.5f, 8.7f, 24.0f}, {0.9f, 0.8f, 4.5f});
  return smooth_subtraction(smooth_union(plate, lobe, 1.0f), hollow, 0.5f);
}

float moai_distance(const Vec3& point) {
  const Vec3 x{point.x(), std::abs(point.y()), point.z()};
  float stone = smooth_union(head(x), jaw(x), 2.5f);
  stone = smooth_union(stone, brow(x), 3.0f);
  stone = smooth_subtraction(stone, socket(x), 0.8f);
  stone = smooth_union(stone, nose(x), 1.0f);
  stone = smooth_union(stone, lips(x), 1.0f);
  stone = smooth_union(stone, ear(x), 1.0f);
  return std::max(stone, -x.z());
}

}  // namespace

ImplicitShape moai_shape() {
  constexpr float margin = 0.05f;  // keeps the faces of the bounds off the stone
  return {moai_distance, {{-8.9f, -8.85f, -margin}, {11.65f, 8.85f, 40.0f + margin}}};
}

}  // namespace mallow

#include "simulation/near_origin.h"

#include <cmath>

namespace mallow {
namespace {

constexpr float k_far = 1000;  // in spacings

double along(const Vec3& a, const Vec3& b) {
  return a.cast<double>().dot(b.cast<double>());
}

void shift(const Vec3& origin, Plane& plane) {
  plane.offset = static_cast<float>(static_cast<double>(plane.offset) - along(plane.normal, origin));
}
void shift(const Vec3& origin, Sphere& sphere) {
  sphere.center = relative_to(origin, sphere.center);
}
void shift(const Vec3& origin, Box& box) {
  box.min = relative_to(origin, box.min);
  box.max = relative_to(origin, box.max);
}
void shift(const Vec3& origin, Union& shapes) {
  for (Primitive& part : shapes.parts) std::visit([&](auto& shape) { shift(origin, shape); }, part);
}

}  // namespace

Vec3 choose_origin(const Body& body) {
  Vec3 low = body.positions.front(), high = low;
  for (const Vec3& x : body.positions) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  Vec3 origin = 0.5f * low + 0.5f * high;
  for (float& c : origin) c = std::abs(c) > k_far * body.spacing ? std::round(c) : 0.0f;
  return origin;
}

Vec3 relative_to(const Vec3& origin, const Vec3& x) {
  return (x.cast<double>() - origin.cast<double>()).cast<float>();
}

Collider relative_to(const Vec3& origin, const Collider& collider) {
  Collider near = collider;
  std::visit([&](auto& shape) { shift(origin, shape); }, near.shape);
  return near;
}

}  // namespace mallow

#include "view/pick.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace mallow::view {
namespace {

/// Distance to a triangle, infinite where the ray misses it [Möller & Trumbore 1997].
float distance_to(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr float k_none = std::numeric_limits<float>::infinity();
  const Vec3 u = b - a, v = c - a, across = ray.direction.cross(v);
  const float scale = u.dot(across);
  if (scale == 0) return k_none;
  const Vec3 from = ray.origin - a;
  const float s = from.dot(across) / scale;
  if (s < 0 || s > 1) return k_none;
  const Vec3 other = from.cross(u);
  const float t = ray.direction.dot(other) / scale;
  if (t < 0 || s + t > 1) return k_none;
  const float distance = v.dot(other) / scale;
  return distance > 0 ? distance : k_none;
}

float distance_to(const Ray& ray, const Vec3& center, float radius) {
  const Vec3 from = ray.origin - center;
  const float half = from.dot(ray.direction);
  const float rest = half * half - from.squaredNorm() + radius * radius;
  if (rest < 0) return std::numeric_limits<float>::infinity();
  const float distance = -half - std::sqrt(rest);
  return distance > 0 ? distance : std::numeric_limits<float>::infinity();
}

}  // namespace

std::optional<Vec3> pick(const Frame& frame, const Ray& ray) {
  float nearest = std::numeric_limits<float>::infinity();
  for (const auto& [a, b, c] : frame.mesh.triangles)
    nearest = std::min(
        nearest, distance_to(ray, frame.mesh.vertices[a], frame.mesh.vertices[b], frame.mesh.vertices[c]));
  for (std::size_t k = 0; k < frame.positions.size(); ++k)
    nearest = std::min(nearest, distance_to(ray, frame.positions[k], frame.radii[frame.bodies[k]]));
  if (!std::isfinite(nearest)) return std::nullopt;
  return Vec3(ray.origin + nearest * ray.direction);
}

Vec3 on_plane(const Ray& ray, const Vec3& point, const Vec3& forward) {
  const float along = ray.direction.dot(forward);
  return ray.origin + ray.direction * ((point - ray.origin).dot(forward) / along);
}

}  // namespace mallow::view

#include "render/obstacles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "render/sampling.h"

namespace mallow::render {
namespace {

// A ray through a face, in either direction. There are at most two per convex shape.
struct Crossing {
  float t = k_far;
  Vec3 normal{0, 0, 0};  // towards the free side
};
using Crossings = std::array<Crossing, 2>;

Crossings cross(const Sphere& sphere, const Ray& ray) {
  const Vec3 to_center = sphere.center - ray.origin;
  const float middle = to_center.dot(ray.direction);
  // From the nearest point of the ray rather than from b² - 4ac, which cancels far from the sphere.
  const Vec3 offset = to_center - middle * ray.direction;
  const float half_squared = sphere.radius * sphere.radius - offset.squaredNorm();
  if (half_squared <= 0) return {};
  const float half = std::sqrt(half_squared);
  const float side = sphere.inside ? -1.0f : 1.0f;
  const auto at = [&](float t) { return Crossing{t, side * (ray.at(t) - sphere.center).normalized()}; };
  return {at(middle - half), at(middle + half)};
}

Crossings cross(const Box& box, const Ray& ray) {
  Crossings result{Crossing{-k_far, {}}, Crossing{k_far, {}}};
  for (int axis = 0; axis < 3; ++axis) {
    const float speed = ray.direction[axis];
    const float low = box.min[axis] - ray.origin[axis];
    const float high = box.max[axis] - ray.origin[axis];
    if (speed == 0) {
      if (low > 0 || high < 0) return {};
      continue;
    }
    const float in = (speed > 0 ? low : high) / speed;
    const float out = (speed > 0 ? high : low) / speed;
    const Vec3 outward = Vec3::Unit(axis) * (box.inside ? -1.0f : 1.0f);
    if (in > result[0].t) result[0] = {in, speed > 0 ? Vec3(-outward) : outward};
    if (out < result[1].t) result[1] = {out, speed > 0 ? outward : Vec3(-outward)};
  }
  if (result[0].t > result[1].t) return {};
  return result;
}

Crossings cross(const Board& board, const Ray& ray) {
  const float speed = board.normal.dot(ray.direction);
  if (speed == 0) return {};
  const float t = board.normal.dot(board.center - ray.origin) / speed;
  const Vec3 offset = ray.at(t) - board.center;
  const float reach = std::max(std::abs(offset.dot(board.u)), std::abs(offset.dot(board.v)));
  if (!(reach <= board.half_side)) return {};
  return {Crossing{t, board.normal}, Crossing{}};
}

// Solid to what comes from the free side; the others are looked through entirely.
bool is_solid(const Sphere&) {
  return true;
}
bool is_solid(const Box&) {
  return true;
}
bool is_solid(const Board& board) {
  return board.seen;
}
// Looked through where it is seen from behind.
bool is_shell(const Sphere& sphere) {
  return sphere.inside;
}
bool is_shell(const Box& box) {
  return box.inside;
}
bool is_shell(const Board& board) {
  return !board.seen;
}

// Width of the lines along the edges of what is looked through, in half heights of the view.
constexpr float k_edge = 0.004f;

// Distance from the nearest edge of the box, at a point on one of its faces.
float edge_distance(const Box& box, const Vec3& position) {
  std::array<float, 3> gaps;
  for (int axis = 0; axis < 3; ++axis) {
    gaps[static_cast<std::size_t>(axis)] =
        std::min(std::abs(position[axis] - box.min[axis]), std::abs(position[axis] - box.max[axis]));
  }
  std::sort(gaps.begin(), gaps.end());
  return gaps[1];
}

Board board_of(const Vec3& normal, float offset, const Camera& camera) {
  const Vec3& near = camera.target;
  const bool seen = normal.dot(camera.eye) > offset;
  // Two sides of the board are level, so that ramps and walls stand straight.
  const Vec3 level = Vec3::UnitZ().cross(normal);
  const Vec3 u = level.norm() > 1e-3f ? Vec3(level.normalized()) : tangents(normal).u;
  return {near - (normal.dot(near) - offset) * normal,
          normal,
          u,
          normal.cross(u),
          1.6f * view_size(camera),
          seen};
}

}  // namespace

float view_size(const Camera& camera) {
  return (camera.target - camera.eye).norm() *
         std::tan(camera.field_of_view * std::numbers::pi_v<float> / 360);
}

Obstacles::Obstacles(std::span<const Collider> colliders, const Camera& camera)
    : view_size_(view_size(camera)) {
  for (const Collider& collider : colliders) {
    std::visit([&](const auto& shape) { add(shape, camera); }, collider.shape);
  }
}

void Obstacles::add(const Plane& plane, const Camera& camera) {
  const float length = plane.normal.norm();
  const Vec3 normal = plane.normal / length;
  const float offset = plane.offset / length;
  if (normal.z() > 0.9999f) {
    floor_ = std::max(offset / normal.z(), floor_.value_or(-k_far));
  } else {
    shapes_.push_back(board_of(normal, offset, camera));
  }
}

void Obstacles::add(const Union& shapes, const Camera& camera) {
  for (const Primitive& part : shapes.parts) {
    std::visit([&](const auto& shape) { add(shape, camera); }, part);
  }
}

std::optional<Obstacles::Hit> Obstacles::nearest(const Ray& ray, float t_max) const {
  std::optional<Hit> hit;
  for (std::uint32_t i = 0; i < shapes_.size(); ++i) {
    if (!std::visit([](const auto& shape) { return is_solid(shape); }, shapes_[i])) continue;
    for (const Crossing& c : std::visit([&](const auto& shape) { return cross(shape, ray); }, shapes_[i])) {
      if (!(c.t > 0 && c.t < t_max) || c.normal.dot(ray.direction) >= 0) continue;
      t_max = c.t;
      hit = Hit{c.t, c.normal, i};
    }
  }
  return hit;
}

bool Obstacles::shades(const Ray& to_light) const {
  for (const Shape& shape : shapes_) {
    if (!std::visit([](const auto& s) { return is_solid(s); }, shape)) continue;
    for (const Crossing& c : std::visit([&](const auto& s) { return cross(s, to_light); }, shape)) {
      if (c.t > 0 && c.t < k_far && c.normal.dot(to_light.direction) > 0) return true;
    }
  }
  return false;
}

Obstacles::Veil Obstacles::veil(const Ray& ray, float t_max) const {
  Veil veil;
  for (std::uint32_t i = 0; i < shapes_.size(); ++i) {
    if (!std::visit([](const auto& shape) { return is_shell(shape); }, shapes_[i])) continue;
    for (const Crossing& c : std::visit([&](const auto& shape) { return cross(shape, ray); }, shapes_[i])) {
      const float cosine = c.normal.dot(ray.direction);
      if (!(c.t > 0 && c.t < t_max) || cosine <= 0) continue;
      t_max = c.t;
      veil = look(shapes_[i], ray.at(c.t), cosine);
      veil.shape = i + 1;
    }
  }
  return veil;
}

Obstacles::Veil Obstacles::look(const Shape& shape, const Vec3& position, float cosine) const {
  if (const Box* box = std::get_if<Box>(&shape)) {
    const bool on_edge = edge_distance(*box, position) < k_edge * view_size_;
    return on_edge ? Veil{0.5f, 0.45f, 0} : Veil{0.05f, 0.9f, 0};
  }
  if (const Board* board = std::get_if<Board>(&shape)) {
    const Vec3 offset = position - board->center;
    const float reach = std::max(std::abs(offset.dot(board->u)), std::abs(offset.dot(board->v)));
    return reach > board->half_side - k_edge * view_size_ ? Veil{0.5f, 0.45f, 0} : Veil{0.1f, 0.6f, 0};
  }
  const float rim = 1 - cosine;
  return {0.04f + 0.4f * rim * rim * rim, 0.9f, 0};
}

}  // namespace mallow::render

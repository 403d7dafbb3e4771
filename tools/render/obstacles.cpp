#include "render/obstacles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "colliders/pose.h"
#include "render/sampling.h"

namespace mallow::render {
namespace {

// Width of the lines along the edges of what is looked through, in half heights of the view.
constexpr float k_edge = 0.004f;

Board board_of(const Plane& plane, const Camera& camera) {
  // Two sides of the board are level, so that ramps and walls stand straight.
  const Vec3 level = Vec3::UnitZ().cross(plane.normal);
  const Vec3 u = level.norm() > 1e-3f ? Vec3(level.normalized()) : tangents(plane.normal).u;
  const Vec3 center = camera.target - (plane.normal.dot(camera.target) - plane.offset) * plane.normal;
  return {center, u, plane.normal.cross(u), 1.6f * view_size(camera)};
}

}  // namespace

float Board::edge_distance(const Vec3& x) const {
  const Vec3 offset = x - center;
  return half_side - std::max(std::abs(offset.dot(u)), std::abs(offset.dot(v)));
}

float view_size(const Camera& camera) {
  return (camera.target - camera.eye).norm() *
         std::tan(camera.field_of_view * std::numbers::pi_v<float> / 360);
}

Obstacles::Obstacles(std::span<const Collider> colliders, const Camera& camera)
    : view_size_(view_size(camera)) {
  for (const Collider& collider : colliders) {
    visit_parts(collider, [&](const auto& shape) { add(shape, collider.pose, camera); });
  }
}

template <class Solid>
void Obstacles::add(const Solid& shape, const Pose& pose, const Camera&) {
  const bool keeps_in = ShapeTraits<Solid>::keeps_in(shape);
  const Aabb tight = placed(bounds(shape), pose);
  const Vec3 margin = Vec3::Constant(1e-3f * view_size_);  // what is rounded at its sides is in it
  const Aabb box{tight.min - margin, tight.max + margin};
  box_ = box_ ? Aabb{box_->min.cwiseMin(box.min), box_->max.cwiseMax(box.max)} : box;
  shapes_.push_back({.shape = shape,
                     .rotation = rotation_of(pose).cast<float>(),
                     .translation = pose.translation.cast<float>(),
                     .box = box,
                     .is_solid = true,
                     .is_shell = keeps_in,
                     .board = std::nullopt});
}

void Obstacles::add(const Plane& of_frame, const Pose& pose, const Camera& camera) {
  const Plane plane = placed(of_frame, pose);
  if (plane.normal.z() > 0.9999f) {
    floor_ = std::max(plane.offset / plane.normal.z(), floor_.value_or(-k_far));
    return;
  }
  is_bounded_ = false;
  const bool seen = plane.normal.dot(camera.eye) > plane.offset;
  shapes_.push_back({.shape = plane,
                     .rotation = Eigen::Matrix3f::Identity(),
                     .translation = {0, 0, 0},
                     .box = {Vec3::Constant(-k_far), Vec3::Constant(k_far)},
                     .is_solid = seen,
                     .is_shell = !seen,
                     .board = board_of(plane, camera)});
}

Crossings Obstacles::cross(const Shape& shape, const Ray& ray) {
  const Vec3 origin = shape.rotation.transpose() * (ray.origin - shape.translation);
  const Vec3 direction = shape.rotation.transpose() * ray.direction;
  Crossings crossings = std::visit(
      [&]<class S>(const S& one) { return ShapeTraits<S>::cross(one, origin, direction); }, shape.shape);
  for (Crossing& crossing : crossings) {
    crossing.normal = shape.rotation * crossing.normal;
    if (shape.board && !(shape.board->edge_distance(ray.at(crossing.t)) >= 0)) crossing = {};
  }
  return crossings;
}

std::optional<Obstacles::Hit> Obstacles::nearest(const Ray& ray, float t_max) const {
  std::optional<Hit> hit;
  for (std::uint32_t i = 0; i < shapes_.size(); ++i) {
    if (!shapes_[i].is_solid || !meets(ray, shapes_[i].box)) continue;
    for (const Crossing& c : cross(shapes_[i], ray)) {
      if (!(c.t > 0 && c.t < t_max) || c.normal.dot(ray.direction) >= 0) continue;
      t_max = c.t;
      hit = Hit{c.t, c.normal, i};
    }
  }
  return hit;
}

bool Obstacles::shades(const Ray& to_light) const {
  for (const Shape& shape : shapes_) {
    if (!shape.is_solid || !meets(to_light, shape.box)) continue;
    for (const Crossing& c : cross(shape, to_light)) {
      if (c.t > 0 && c.t < k_far && c.normal.dot(to_light.direction) > 0) return true;
    }
  }
  return false;
}

Obstacles::Veil Obstacles::veil(const Ray& ray, float t_max) const {
  Veil veil;
  for (std::uint32_t i = 0; i < shapes_.size(); ++i) {
    if (!shapes_[i].is_shell || !meets(ray, shapes_[i].box)) continue;
    for (const Crossing& c : cross(shapes_[i], ray)) {
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
  const float edge_width = k_edge * view_size_;
  if (shape.board)
    return shape.board->edge_distance(position) < edge_width ? Veil{0.5f, 0.45f, 0} : Veil{0.1f, 0.6f, 0};
  const Vec3 own = shape.rotation.transpose() * (position - shape.translation);
  const float edge =
      std::visit([&]<class S>(const S& one) { return ShapeTraits<S>::edge_distance(one, own); }, shape.shape);
  if (edge < k_far) return edge < edge_width ? Veil{0.5f, 0.45f, 0} : Veil{0.05f, 0.9f, 0};
  const float rim = 1 - cosine;
  return {0.04f + 0.4f * rim * rim * rim, 0.9f, 0};
}

}  // namespace mallow::render

#include "program/stills.h"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "program/body_appearances.h"

namespace mallow::program {
namespace {

void extend(Aabb& box, const Aabb& other) {
  box.min = box.min.cwiseMin(other.min);
  box.max = box.max.cwiseMax(other.max);
}

/// The colliders of a scene that are seen.
std::vector<Collider> visible_colliders(const Scene& scene) {
  std::vector<Collider> colliders;
  for (const SceneCollider& collider : scene.colliders)
    if (collider.visible) colliders.push_back(collider);
  return colliders;
}

/// The same where they are at a time.
std::vector<Collider> colliders_at(const Scene& scene, double time) {
  std::vector<Collider> colliders = visible_colliders(scene);
  for (Collider& collider : colliders)
    collider.pose =
        collider.keyframes.empty() ? pose_after(collider, time) : pose_at(collider.keyframes, time);
  return colliders;
}

/// A plane that things come to rest on.
bool is_ground(const Plane& plane) {
  return plane.normal.z() > 0.7f * plane.normal.norm();
}

/// Height of a ground plane below (or above) a point.
float ground_height(const Plane& plane, const Vec3& x) {
  return (plane.offset - plane.normal.x() * x.x() - plane.normal.y() * x.y()) / plane.normal.z();
}

}  // namespace

Aabb view_bounds(const Scene& scene, const ParticleFrame& first) {
  Aabb box{first.positions.at(0), first.positions.at(0)};
  for (const Vec3& x : first.positions) extend(box, {x, x});
  const Vec3 middle = 0.5f * (box.min + box.max);
  const float side = (box.max - box.min).maxCoeff();

  const std::vector<Collider> colliders = visible_colliders(scene);
  float lowest = -std::numeric_limits<float>::infinity();
  const auto add_ground = [&](const Plane& plane) {
    if (!is_ground(plane)) return;
    const Vec3 foot(middle.x(), middle.y(), ground_height(plane, middle));
    // What falls spreads: to about twice its width.
    const Vec3 spread(side, side, 0.0f);
    extend(box, {foot - spread, foot + spread});
    lowest = std::max(lowest, std::min(foot.z(), box.min.z()));
  };
  for (const Collider& collider : colliders)
    visit_parts(collider, [&]<class Shape>(const Shape& shape) {
      if constexpr (std::is_same_v<Shape, Plane>) add_ground(placed(shape, collider.pose));
    });

  // A collider far larger than what moves is a part of the room and does not have to be seen whole.
  const Vec3 reach = Vec3::Constant(0.5f * (box.max - box.min).maxCoeff());
  const Aabb near{box.min - reach, box.max + reach};
  const auto clamped = [&](const Vec3& x) -> Vec3 { return x.cwiseMax(near.min).cwiseMin(near.max); };
  for (const Collider& collider : colliders)
    visit_parts(collider, [&]<class Shape>(const Shape& shape) {
      if constexpr (std::is_same_v<Shape, Plane>) return;  // endless
      const Aabb whole = placed(bounds(shape), collider.pose);
      extend(box, {clamped(whole.min), clamped(whole.max)});
    });
  box.min.z() = std::max(box.min.z(), lowest);  // what is below the ground is not seen
  return box;
}

Stills::Stills(const Scene& scene, const ParticleFrame& first, std::span<const float> spacings, int threads)
    : scene_(scene),
      renderer_(scene.render, threads),
      camera_(render::frame_camera(view_bounds(scene, first), scene.render)),
      palette_(body_appearances(scene)),
      ball_radius_(0.5f * *std::min_element(spacings.begin(), spacings.end())) {}

void Stills::take(const ParticleFrame& frame, const Mesh& surface, const std::filesystem::path& file) {
  const std::vector<Collider> colliders = colliders_at(scene_, frame.time);
  render::write_png(file, surface.triangles.empty()
                              ? renderer_.render_points(frame.positions, ball_radius_, frame.bodies, palette_,
                                                        colliders, camera_)
                              : renderer_.render(surface, palette_, colliders, camera_));
}

}  // namespace mallow::program

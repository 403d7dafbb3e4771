#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "render/renderer.h"
#include "render/viewport.h"

namespace mallow::render {
namespace {

// Share of the picture's height and width that the bounds may fill.
constexpr float k_fill = 0.88f;

// Interval of camera-space offsets along one axis that the bounds' corners ask for: an eye at e sees a corner
// at (x, f) where |x - e| <= slope (f - e_f). `above` and `below` are the two sides' tightest lines.
struct Sides {
  float above = -k_far_side;
  float below = -k_far_side;
  static constexpr float k_far_side = 1e30f;
  void add(float x, float forward, float slope) {
    above = std::max(above, x - slope * forward);
    below = std::max(below, -x - slope * forward);
  }
  float middle() const { return (above - below) / 2; }
  // The eye's place along the view where the two lines meet: the nearest from which both sides are seen.
  float nearest(float slope) const { return -(above + below) / (2 * slope); }
};

// How many planes are looked through from `side`, far away.
int planes_between(const Vec3& side, const Collider& collider) {
  int count = 0;
  visit_parts(collider, [&]<class Shape>(const Shape& shape) {
    if constexpr (std::is_same_v<Shape, Plane>)
      count += placed(shape, collider.pose).normal.dot(side) < 0 ? 1 : 0;
  });
  return count;
}

// Whether something is made to hold what moves: one looks into it from above.
bool is_vessel(const Collider& collider) {
  constexpr int k_walls = 4;
  int solids = 0;
  bool keeps_in = false;
  visit_parts(collider, [&]<class Shape>(const Shape& shape) {
    if constexpr (!std::is_same_v<Shape, Plane>) {
      ++solids;
      keeps_in = keeps_in || ShapeTraits<Shape>::keeps_in(shape);
    }
  });
  return keeps_in || solids >= k_walls;
}

// The direction from the scene to the eye: three quarters from the front, +x, unless another side sees more
// ramps and walls from their free side.
Vec3 view_side(std::span<const Collider> colliders) {
  constexpr float k_degree = std::numbers::pi_v<float> / 180;
  const float elevation = (std::ranges::any_of(colliders, is_vessel) ? 36 : 20) * k_degree;
  Vec3 best = Vec3::Zero();
  int fewest = std::numeric_limits<int>::max();
  for (const float azimuth : {-38.0f, 38.0f, -142.0f, 142.0f}) {
    const Vec3 side(std::cos(elevation) * std::cos(azimuth * k_degree),
                    std::cos(elevation) * std::sin(azimuth * k_degree), std::sin(elevation));
    int between = 0;
    for (const Collider& collider : colliders) between += planes_between(side, collider);
    if (between >= fewest) continue;
    fewest = between;
    best = side;
  }
  return best;
}

}  // namespace

Camera frame_camera(const Aabb& scene_bounds, const RenderConfig& config,
                    std::span<const Collider> colliders) {
  return frame_camera(std::span(&scene_bounds, 1), config, colliders);
}

Camera frame_camera(std::span<const Aabb> boxes, const RenderConfig& config,
                    std::span<const Collider> colliders) {
  Aabb bounds = boxes.front();
  for (const Aabb& box : boxes) bounds = {bounds.min.cwiseMin(box.min), bounds.max.cwiseMax(box.max)};
  Camera camera;
  camera.field_of_view = config.field_of_view;
  const Vec3 middle = (bounds.min + bounds.max) / 2;
  if (config.eye) {
    camera.eye = *config.eye;
    camera.target = config.target.value_or(middle);
    return camera;
  }

  const Vec3 forward = -view_side(colliders);
  const Vec3 origin = config.target.value_or(middle);
  const Viewport view({.eye = origin - forward, .target = origin, .field_of_view = config.field_of_view},
                      config.width, config.height);
  const float slope_x = k_fill * view.right.norm();
  const float slope_y = k_fill * view.up.norm();
  Sides horizontal, vertical;
  const float half_diagonal = std::max((bounds.max - bounds.min).norm() / 2, 1e-3f);
  for (const Aabb& box : boxes)
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 offset;
      for (int axis = 0; axis < 3; ++axis)
        offset[axis] = (corner >> axis & 1 ? box.max : box.min)[axis] - origin[axis];
      horizontal.add(offset.dot(view.right.normalized()), offset.dot(forward), slope_x);
      vertical.add(offset.dot(view.up.normalized()), offset.dot(forward), slope_y);
    }
  if (config.target) {
    const float distance = std::max({horizontal.above / slope_x, horizontal.below / slope_x,
                                     vertical.above / slope_y, vertical.below / slope_y, half_diagonal});
    camera.target = origin;
    camera.eye = origin - distance * forward;
    return camera;
  }
  const float along = std::min({horizontal.nearest(slope_x), vertical.nearest(slope_y), -half_diagonal});
  // Room that is left over goes above the bounds rather than below: the ground is near the bottom of the
  // picture.
  const float room = -(vertical.above + vertical.below) / 2 - slope_y * along;
  const float rise = vertical.middle() + 0.5f * room;
  camera.eye =
      origin + along * forward + horizontal.middle() * view.right.normalized() + rise * view.up.normalized();
  camera.target = camera.eye + forward * (middle - camera.eye).dot(forward);
  return camera;
}

}  // namespace mallow::render

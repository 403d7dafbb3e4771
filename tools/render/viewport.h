#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>

#include "render/obstacles.h"
#include "render/renderer.h"

namespace mallow::render {

/// The picture plane at distance 1 from the eye: pixels to rays.
struct Viewport {
  Vec3 eye, forward;
  Vec3 right, up;  ///< from the middle of the picture to its right and upper side
  float width, height;

  Viewport(const Camera& camera, int pixels_x, int pixels_y)
      : eye(camera.eye),
        forward((camera.target - camera.eye).normalized()),
        width(static_cast<float>(pixels_x)),
        height(static_cast<float>(pixels_y)) {
    Vec3 side = forward.cross(camera.up);
    if (side.norm() < 1e-4f) side = forward.cross(Vec3::UnitY());  // looking straight up or down
    const float half_height = std::tan(camera.field_of_view * std::numbers::pi_v<float> / 360);
    right = side.normalized() * (half_height * width / height);
    up = side.normalized().cross(forward) * half_height;
  }

  /// Through (x, y), in pixels from the upper left corner of the picture.
  Ray ray(float x, float y) const {
    return {eye, (forward + (2 * x / width - 1) * right + (1 - 2 * y / height) * up).normalized()};
  }
  /// Where a point is seen, in the same pixels; nothing where it is not in front of the eye.
  std::optional<Eigen::Vector2f> pixel(const Vec3& point) const {
    const Vec3 offset = point - eye;
    const float depth = offset.dot(forward);
    if (!(depth > 0)) return std::nullopt;
    return Eigen::Vector2f(width / 2 * (1 + offset.dot(right) / (depth * right.squaredNorm())),
                           height / 2 * (1 - offset.dot(up) / (depth * up.squaredNorm())));
  }
  /// Side of a pixel's footprint per metre of distance.
  float footprint() const { return 2 * up.norm() / height; }
};

}  // namespace mallow::render

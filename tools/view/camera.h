#pragma once

#include <Eigen/Core>

#include "mallow/body.h"
#include "mallow/vec3.h"
#include "render/renderer.h"

namespace mallow::view {

/// A line into the scene.
struct Ray {
  Vec3 origin{0, 0, 0};     ///< [m]
  Vec3 direction{0, 0, 1};  ///< unit length
};

/// A camera that goes around a target, z up.
class OrbitCamera {
 public:
  OrbitCamera() = default;
  /// As `mallow render` would look at the scene. bounds: what is to be seen [m].
  OrbitCamera(const render::Camera& camera, const Aabb& bounds);

  void set_aspect(float width_by_height) { aspect_ = width_by_height; }
  /// Turns by pixels of the mouse; the eye stays off the poles.
  void turn(float right, float down);
  /// Moves the target across the view; the offset is in heights of the picture.
  void pan(float right, float down);
  /// clicks of the wheel; above 0 nearer.
  void zoom(float clicks);
  void set_field_of_view(float degrees) { field_of_view_ = degrees; }

  Vec3 eye() const;
  const Vec3& target() const { return target_; }
  /// Unit vectors of the view.
  Vec3 forward() const;
  Vec3 right() const;
  Vec3 up() const;
  /// x, y: in [-1, 1] from the left and from the bottom of the picture.
  Ray ray(float x, float y) const;
  /// Half of the picture's height at the target [m].
  float view_size() const;
  render::Camera as_render_camera() const;

  /// World to clip space.
  Eigen::Matrix4f projection_view() const;
  Eigen::Matrix4f view() const;
  Eigen::Matrix4f projection() const;

 private:
  float half_height() const;  ///< tangent of half of the field of view

  Vec3 target_{0, 0, 0};
  float distance_ = 3;        ///< from eye to target [m]
  float azimuth_ = 0;         ///< of the eye [rad]
  float elevation_ = 0.3f;    ///< of the eye [rad]
  float field_of_view_ = 35;  ///< vertical [degrees]
  float aspect_ = 1;
  float reach_ = 10;  ///< half of the diagonal of what is to be seen [m]
};

}  // namespace mallow::view

#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>

#include "mallow/vec3.h"
#include "view/gl_program.h"

namespace mallow::view {

/// The text of a shader behind that of light. finish: that of all bodies; -1: of each its own.
std::string with_light(bool plain, const std::string& text, int finish = -1);

/// The studio around a scene, and its floor.
class Backdrop {
 public:
  /// plain: see SceneDrawer.
  explicit Backdrop(bool plain);

  struct View {
    Eigen::Matrix4f from_clip;  ///< to the world
    bool sees_floor;
    Aabb shadows;  ///< what throws them, on the shadow map: x and y in [0, 1]
  };
  /// set_light: makes a program the one in use, and tells it of light and camera. Behind all that was drawn.
  void draw(const View& view, const std::function<void(GlProgram&)>& set_light);

 private:
  const bool plain_;
  GlProgram studio_, floor_;
  std::unique_ptr<GlProgram> open_floor_;  ///< where no shadow falls; of plain ones
};

}  // namespace mallow::view

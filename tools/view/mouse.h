#pragma once

#include <optional>

#include "view/camera.h"
#include "view/frame.h"
#include "view/panels.h"
#include "view/view_state.h"

namespace mallow::view {

/// What the hand does in the picture: the tool's work as commands, and turns of the camera.
class Mouse {
 public:
  /// button: 0 left, 1 right, 2 middle. frame: what is seen.
  void button(int button, bool pressed, bool shift, const Frame& frame, OrbitCamera& camera, ViewState& state,
              const Send& send);
  /// x, y: pixels of a window of that size.
  void move(float x, float y, float width, float height, OrbitCamera& camera, const Send& send);
  bool is_at_work() const { return grabbed_ || drags_ != Drag::none; }
  /// From where a cut is being drawn, in pixels.
  const std::optional<Vec3>& cut_from() const { return cut_from_; }
  float x() const { return x_; }
  float y() const { return y_; }

 private:
  enum class Drag { none, turn, move };
  Ray ray(const OrbitCamera& camera) const;
  void press(const Frame& frame, const OrbitCamera& camera, ViewState& state, const Send& send);
  void release(const OrbitCamera& camera, const Send& send);

  float x_ = 0, y_ = 0, width_ = 1, height_ = 1;
  Drag drags_ = Drag::none;
  std::optional<Vec3> grabbed_;  ///< where, which tells how far away the mouse pulls [m]
  std::optional<Vec3> cut_from_;
  Ray cut_start_;
};

}  // namespace mallow::view

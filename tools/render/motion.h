#pragma once

#include <cstdint>
#include <vector>

#include "mallow/mesh.h"
#include "render/viewport.h"

namespace mallow::render {

/// Where in a picture something moves while the shutter is open.
class MotionMap {
 public:
  /// exposure: time for which it is open [s].
  MotionMap(const Mesh& mesh, float exposure, const Viewport& view);
  MotionMap() = default;  ///< nothing moves

  /// Whether what moves is seen at or near a pixel.
  bool at(int x, int y) const {
    return !moves_.empty() && moves_[static_cast<std::size_t>(y / k_cell) * static_cast<std::size_t>(width_) +
                                     static_cast<std::size_t>(x / k_cell)] != 0;
  }

 private:
  static constexpr int k_cell = 8;  // pixels
  int width_ = 0, height_ = 0;      // in cells
  std::vector<std::uint8_t> moves_;
};

}  // namespace mallow::render

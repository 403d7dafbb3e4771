#include "render/motion.h"

#include <algorithm>
#include <cmath>

namespace mallow::render {
namespace {

// What moves less is not blurred [pixels].
constexpr float k_least = 0.5f;

}  // namespace

MotionMap::MotionMap(const Mesh& mesh, float exposure, const Viewport& view)
    : width_((static_cast<int>(view.width) + k_cell - 1) / k_cell),
      height_((static_cast<int>(view.height) + k_cell - 1) / k_cell),
      moves_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {
  for (std::size_t v = 0; v < mesh.velocities.size(); ++v) {
    const Vec3 half = 0.5f * exposure * mesh.velocities[v];
    const auto from = view.pixel(mesh.vertices[v] - half), to = view.pixel(mesh.vertices[v] + half);
    if (!from || !to || !((*to - *from).norm() > k_least)) continue;
    // A cell more on each side, for the triangles around the vertex.
    const auto cell = [&](float pixel, int cells, int margin) {
      return std::clamp(static_cast<int>(std::clamp(pixel / k_cell, -1.0f, 1e4f)) + margin, 0, cells - 1);
    };
    for (int y = cell(std::min(from->y(), to->y()), height_, -1);
         y <= cell(std::max(from->y(), to->y()), height_, 1); ++y)
      for (int x = cell(std::min(from->x(), to->x()), width_, -1);
           x <= cell(std::max(from->x(), to->x()), width_, 1); ++x)
        moves_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)] =
            1;
  }
}

}  // namespace mallow::render

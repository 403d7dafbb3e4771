#include "mallow/group_colors.h"

#include <array>

namespace mallow::cli {
namespace {

/// Linear RGB; for materials that name no colour.
const std::array<Vec3, 8> k_palette = {
    Vec3{0.80f, 0.24f, 0.09f}, Vec3{0.05f, 0.36f, 0.55f}, Vec3{0.85f, 0.55f, 0.08f},
    Vec3{0.18f, 0.48f, 0.14f}, Vec3{0.50f, 0.12f, 0.42f}, Vec3{0.03f, 0.45f, 0.42f},
    Vec3{0.75f, 0.30f, 0.34f}, Vec3{0.35f, 0.25f, 0.16f},
};

}  // namespace

std::vector<Vec3> group_colors(const Scene& scene) {
  std::vector<Vec3> colors;
  for (const std::size_t material : group_materials(scene)) {
    colors.push_back(scene.materials[material].color.value_or(k_palette[material % k_palette.size()]));
  }
  return colors;
}

}  // namespace mallow::cli

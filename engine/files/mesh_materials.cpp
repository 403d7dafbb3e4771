#include "files/mesh_materials.h"

#include <algorithm>
#include <string>

#include "mallow/errors.h"

namespace mallow {

std::uint8_t triangle_material(const Mesh& mesh, std::size_t triangle) {
  if (mesh.material_ids.empty()) return 0;
  const auto& corners = mesh.triangles[triangle];
  const std::uint8_t a = mesh.material_ids[corners[0]], b = mesh.material_ids[corners[1]],
                     c = mesh.material_ids[corners[2]];
  if (a == b || a == c) return a;
  return b == c ? b : std::min({a, b, c});
}

void require_appearances(const Mesh& mesh, std::span<const Appearance> palette) {
  for (std::size_t k = 0; k < palette.size(); ++k) {
    const auto color = palette[k].color.array();
    if ((color >= 0).all() && (color <= 1).all()) continue;
    throw ConfigError("palette[" + std::to_string(k) + "].color", "is not allowed: linear RGB in [0, 1]");
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint8_t id = triangle_material(mesh, t);
    if (id < palette.size()) continue;
    throw ConfigError("palette", std::to_string(palette.size()) + " are not allowed: material id " +
                                     std::to_string(id) + " needs one too");
  }
}

}  // namespace mallow

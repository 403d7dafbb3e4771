#include "files/mesh_materials.h"

#include <string>

#include "mallow/errors.h"

namespace mallow {

std::uint8_t triangle_material(const Mesh& mesh, std::size_t triangle) {
  return mesh.material_ids.empty() ? std::uint8_t{0} : mesh.material_ids[mesh.triangles[triangle][0]];
}

void require_colors(const Mesh& mesh, std::span<const Vec3> colors) {
  for (std::size_t k = 0; k < colors.size(); ++k) {
    if ((colors[k].array() >= 0).all() && (colors[k].array() <= 1).all()) continue;
    throw ConfigError("colors[" + std::to_string(k) + ']', "is not allowed: linear RGB in [0, 1]");
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint8_t id = triangle_material(mesh, t);
    if (id < colors.size()) continue;
    throw ConfigError("colors", std::to_string(colors.size()) + " are not allowed: material id " +
                                    std::to_string(id) + " needs one too");
  }
}

}  // namespace mallow

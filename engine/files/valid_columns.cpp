#include "files/valid_columns.h"

#include <algorithm>
#include <string>

#include "mallow/errors.h"

namespace mallow {
namespace {

template <class T>
void require_per_vertex(const char* field, const std::vector<T>& values, const Mesh& mesh) {
  if (values.empty() || values.size() == mesh.vertices.size()) return;
  throw ConfigError(field, std::to_string(values.size()) +
                               " are not allowed: none, or as many as vertices (" +
                               std::to_string(mesh.vertices.size()) + ')');
}

void require_finite(const char* field, const std::vector<Vec3>& vectors) {
  const auto wrong =
      std::find_if(vectors.begin(), vectors.end(), [](const Vec3& v) { return !v.allFinite(); });
  if (wrong == vectors.end()) return;
  throw ConfigError(field + ('[' + std::to_string(wrong - vectors.begin()) + ']'),
                    "is not allowed: finite numbers");
}

}  // namespace

void require_valid(const Mesh& mesh) {
  require_per_vertex("mesh.normals", mesh.normals, mesh);
  require_per_vertex("mesh.velocities", mesh.velocities, mesh);
  require_per_vertex("mesh.material_ids", mesh.material_ids, mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t vertex : mesh.triangles[t]) {
      if (vertex < mesh.vertices.size()) continue;
      throw ConfigError("mesh.triangles[" + std::to_string(t) + ']',
                        "vertex " + std::to_string(vertex) + " is not allowed: there are " +
                            std::to_string(mesh.vertices.size()));
    }
  }
}

void require_finite(const Mesh& mesh) {
  require_finite("mesh.vertices", mesh.vertices);
  require_finite("mesh.normals", mesh.normals);
  require_finite("mesh.velocities", mesh.velocities);
}

void require_valid(const ParticleFrame& frame) {
  const auto require = [&](const char* field, std::size_t count) {
    if (count == frame.positions.size()) return;
    throw ConfigError(field, std::to_string(count) + " are not allowed: as many as positions (" +
                                 std::to_string(frame.positions.size()) + ')');
  };
  require("frame.velocities", frame.velocities.size());
  require("frame.bodies", frame.bodies.size());
  if (!frame.ids.empty()) require("frame.ids", frame.ids.size());
  if (!frame.alphas.empty()) require("frame.alphas", frame.alphas.size());
  if (!frame.temperatures.empty()) require("frame.temperatures", frame.temperatures.size());
}

}  // namespace mallow

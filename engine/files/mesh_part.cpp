#include "files/mesh_part.h"

#include <algorithm>

namespace mallow {

MeshPart part_of(const Mesh& mesh, std::span<const std::size_t> triangles) {
  MeshPart part;
  for (const std::size_t t : triangles)
    part.corners.insert(part.corners.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
  part.vertices = part.corners;
  std::sort(part.vertices.begin(), part.vertices.end());
  part.vertices.erase(std::unique(part.vertices.begin(), part.vertices.end()), part.vertices.end());
  for (std::uint32_t& corner : part.corners) {
    const auto at = std::lower_bound(part.vertices.begin(), part.vertices.end(), corner);
    corner = static_cast<std::uint32_t>(at - part.vertices.begin());
  }
  return part;
}

std::vector<Vec3> picked(const std::vector<Vec3>& vectors, const std::vector<std::uint32_t>& rows) {
  std::vector<Vec3> result;
  if (vectors.empty()) return result;
  result.reserve(rows.size());
  for (const std::uint32_t row : rows) result.push_back(vectors[row]);
  return result;
}

}  // namespace mallow

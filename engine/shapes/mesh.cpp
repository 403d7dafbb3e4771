#include "mallow/mesh.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

namespace mallow {

Aabb bounds(const Mesh& mesh) {
  if (mesh.vertices.empty()) return {};
  Aabb box{mesh.vertices.front(), mesh.vertices.front()};
  for (const Vec3& vertex : mesh.vertices) {
    box.min = box.min.cwiseMin(vertex);
    box.max = box.max.cwiseMax(vertex);
  }
  return box;
}

std::string why_not_closed(const Mesh& mesh) {
  if (mesh.triangles.empty()) return "no triangles";

  // Sorted, so that the triangles of an edge stand side by side.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangle[k], triangle[(k + 1) % 3]);
      // An edge without length bounds nothing; a triangle that has one meets its other edge twice.
      if (low != high) edges.emplace_back(low, high);
    }
  }
  if (edges.empty()) return "no triangles that enclose anything";
  std::sort(edges.begin(), edges.end());

  std::size_t open = 0;
  std::pair<std::uint32_t, std::uint32_t> first;
  for (auto begin = edges.begin(); begin != edges.end();) {
    const auto end = std::find_if(begin, edges.end(), [&](const auto& edge) { return edge != *begin; });
    if ((end - begin) % 2 != 0 && open++ == 0) first = *begin;
    begin = end;
  }
  if (open == 0) return {};
  return std::to_string(open) + (open == 1 ? " open edge" : " open edges") +
         (open == 1 ? ", between vertices " : ", the first between vertices ") + std::to_string(first.first) +
         " and " + std::to_string(first.second);
}

}  // namespace mallow

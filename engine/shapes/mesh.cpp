#include "mallow/mesh.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>

#include "core/precision.h"

namespace mallow {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// Edges that belong to an odd number of triangles; all edges that have a length go into `edges`, sorted.
std::vector<Edge> find_open_edges(const Mesh& mesh, std::vector<Edge>& edges) {
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangle[k], triangle[(k + 1) % 3]);
      // An edge without length bounds nothing; a triangle that has one meets its other edge twice.
      if (low != high) edges.emplace_back(low, high);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<Edge> open;
  for (auto begin = edges.begin(); begin != edges.end();) {
    const auto end = std::find_if(begin, edges.end(), [&](const auto& edge) { return edge != *begin; });
    if ((end - begin) % 2 != 0) open.push_back(*begin);
    begin = end;
  }
  return open;
}

/// ", of which (0 0 1) and (0 0 1.001) nearly coincide, 0.001 apart", where corners of open edges do,
/// measured by the mesh. Looks at the first thousands of them only: a mesh that is open everywhere has other
/// troubles.
std::string near_misses(const Mesh& mesh, const std::vector<Edge>& open) {
  constexpr std::size_t k_most = 4000;
  constexpr float k_near = 1e-3f;  // of the longest side of the mesh
  std::vector<std::uint32_t> corners;
  for (const auto& [a, b] : open) corners.insert(corners.end(), {a, b});
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  corners.resize(std::min(corners.size(), k_most));
  const Aabb box = bounds(mesh);
  float nearest = k_near * (box.max - box.min).maxCoeff();
  Edge pair{0, 0};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t j = i + 1; j < corners.size(); ++j) {
      const float distance = (mesh.vertices[corners[i]] - mesh.vertices[corners[j]]).norm();
      // Two ends of an edge are two corners by intent, however short it is.
      if (!(distance < nearest) || std::binary_search(open.begin(), open.end(), Edge{corners[i], corners[j]}))
        continue;
      nearest = distance;
      pair = {corners[i], corners[j]};
    }
  }
  if (pair.first == pair.second) return {};
  std::ostringstream text;
  text << "; (" << text_of(mesh.vertices[pair.first]) << ") and (" << text_of(mesh.vertices[pair.second])
       << ") are corners of open edges only " << nearest << " apart, and may be meant to be one";
  return text.str();
}

}  // namespace

Aabb bounds(const Mesh& mesh) {
  if (mesh.vertices.empty()) return {};
  Aabb box{mesh.vertices.front(), mesh.vertices.front()};
  for (const Vec3& vertex : mesh.vertices) {
    box.min = box.min.cwiseMin(vertex);
    box.max = box.max.cwiseMax(vertex);
  }
  return box;
}

// Corners meet by sorting: whoever writes a file can choose corners that collide in a hash table.
Mesh welded(const Mesh& mesh) {
  const auto place = [&](std::uint32_t v) -> const Vec3& { return mesh.vertices[v]; };
  std::vector<std::uint32_t> sorted(mesh.vertices.size());
  std::iota(sorted.begin(), sorted.end(), 0u);
  std::sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 &p = place(a), &q = place(b);
    return std::tie(p.x(), p.y(), p.z(), a) < std::tie(q.x(), q.y(), q.z(), b);
  });
  std::vector<std::uint32_t> first(sorted.size());  // by vertex: the first one at its place
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const bool same = k > 0 && place(sorted[k]) == place(sorted[k - 1]);
    first[sorted[k]] = same ? first[sorted[k - 1]] : sorted[k];
  }
  Mesh result;
  std::vector<std::uint32_t>& vertex = sorted;  // by vertex: its number in the result, from here on
  for (std::uint32_t v = 0; v < vertex.size(); ++v) {
    const bool is_new = first[v] == v;
    vertex[v] = is_new ? static_cast<std::uint32_t>(result.vertices.size()) : vertex[first[v]];
    if (is_new) result.vertices.push_back(place(v) + Vec3::Zero());  // -0 becomes 0
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array triangle{vertex[a], vertex[b], vertex[c]};
    if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
      result.triangles.push_back(triangle);
  }
  return result;
}

std::string why_not_closed(const Mesh& mesh) {
  if (mesh.triangles.empty()) return "no triangles";
  std::vector<Edge> edges;
  const std::vector<Edge> open = find_open_edges(mesh, edges);
  if (edges.empty()) return "no triangles that enclose anything";
  if (open.empty()) return {};
  std::ostringstream text;
  text << open.size() << (open.size() == 1 ? " open edge, from (" : " open edges, the first from (")
       << text_of(mesh.vertices[open[0].first]) << ") to (" << text_of(mesh.vertices[open[0].second]) << ')'
       << near_misses(mesh, open);
  return text.str();
}

}  // namespace mallow

#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mallow/mesh.h"

namespace mallow {

/// What keeps a mesh from being a closed, oriented 2-manifold of triangles with an area; empty if nothing
/// does.
inline std::string why_not_manifold(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> fans(mesh.vertices.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 &x = mesh.vertices[a], &y = mesh.vertices[b], &z = mesh.vertices[c];
    if (!((y - x).cross(z - x).norm() > 0)) return "a triangle without area";
    for (const auto& edge : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      if (++edges[edge] > 1) return "an edge twice in one direction";
    fans[a].emplace_back(b, c);
    fans[b].emplace_back(c, a);
    fans[c].emplace_back(a, b);
  }
  for (const auto& [edge, count] : edges)
    if (!edges.contains({edge.second, edge.first})) return "an edge with one side";
  for (const auto& fan : fans) {
    if (fan.empty()) return "a vertex without triangles";
    std::map<std::uint32_t, std::uint32_t> next(fan.begin(), fan.end());
    std::size_t steps = 0;
    for (std::uint32_t at = fan[0].first; steps == 0 || at != fan[0].first; at = next.at(at)) ++steps;
    if (steps != fan.size()) return "a vertex where two sheets meet";
  }
  return "";
}

}  // namespace mallow

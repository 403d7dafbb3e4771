#include "surface/mesh_parts.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Values that go from one place to another.
struct Move {
  std::size_t from, to, count;
  bool fresh;
};

/// Puts the values of all parts where they belong, those that stay first. Kept ones do not cross: those that
/// go down are moved from the first on, then those that go up from the last on, and none is overwritten
/// before it has been moved.
template <class T>
void move_values(std::span<const Move> moves, std::size_t size, const std::vector<T>& fresh,
                 std::vector<T>& values) {
  if (fresh.empty() && values.empty()) return;
  if (values.size() < size) values.resize(size);
  const auto at = [](auto& of, std::size_t k) { return of.begin() + static_cast<std::ptrdiff_t>(k); };
  for (const Move& m : moves)
    if (!m.fresh && m.to < m.from)
      std::copy(at(values, m.from), at(values, m.from + m.count), at(values, m.to));
  for (std::size_t k = moves.size(); k-- > 0;)
    if (const Move& m = moves[k]; !m.fresh && m.to > m.from)
      std::copy_backward(at(values, m.from), at(values, m.from + m.count), at(values, m.to + m.count));
  for (const Move& m : moves)
    if (m.fresh) std::copy(at(fresh, m.from), at(fresh, m.from + m.count), at(values, m.to));
  values.resize(size);
}

/// Numbers the vertices of triangles anew.
void shift(const Move& vertices, const Move& triangles, const Threads& threads, Mesh& mesh) {
  const auto by = static_cast<std::uint32_t>(vertices.to - vertices.from);  // modulo 2^32
  if (by == 0) return;
  parallel_for(threads, triangles.count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      for (std::uint32_t& v : mesh.triangles[triangles.to + t]) v += by;
  });
}

}  // namespace

void put_together(const Mesh& fresh, const Threads& threads, std::span<MeshPart> parts, Mesh& mesh) {
  std::vector<Move> vertices, triangles;
  std::size_t vertex = 0, triangle = 0;
  for (MeshPart& part : parts) {
    vertices.push_back({part.first_vertex, vertex, part.vertices, part.fresh});
    triangles.push_back({part.first_triangle, triangle, part.triangles, part.fresh});
    part = {vertex, part.vertices, triangle, part.triangles};
    vertex += part.vertices;
    triangle += part.triangles;
  }
  move_values(vertices, vertex, fresh.vertices, mesh.vertices);
  move_values(vertices, vertex, fresh.normals, mesh.normals);
  move_values(vertices, vertex, fresh.velocities, mesh.velocities);
  move_values(vertices, vertex, fresh.material_ids, mesh.material_ids);
  move_values(triangles, triangle, fresh.triangles, mesh.triangles);
  for (std::size_t k = 0; k < parts.size(); ++k) shift(vertices[k], triangles[k], threads, mesh);
}

}  // namespace mallow

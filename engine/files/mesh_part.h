#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mallow/mesh.h"

namespace mallow {

/// Those vertices of a mesh that some of its triangles have, and the triangles' corners among them.
struct MeshPart {
  std::vector<std::uint32_t> vertices;  ///< ascending
  std::vector<std::uint32_t> corners;
};
/// triangles: indices of triangles of the mesh.
MeshPart part_of(const Mesh& mesh, std::span<const std::size_t> triangles);

/// Rows of a column; nothing where the column is empty.
std::vector<Vec3> picked(const std::vector<Vec3>& vectors, const std::vector<std::uint32_t>& rows);

}  // namespace mallow

#pragma once

#include <cstddef>
#include <span>

#include "core/threads.h"
#include "mallow/mesh.h"

namespace mallow {

/// A part of a mesh: ranges of its vertices and triangles, which have no other vertices.
struct MeshPart {
  std::size_t first_vertex = 0, vertices = 0, first_triangle = 0, triangles = 0;
  bool fresh = false;  ///< it lies in the mesh of what was drawn anew
};

/// Puts parts, each of which lies in `mesh`, in ascending order, or in `fresh`, behind each other into
/// `mesh`; what else was there is gone. parts: where they lie, before and after.
void put_together(const Mesh& fresh, const Threads& threads, std::span<MeshPart> parts, Mesh& mesh);

}  // namespace mallow

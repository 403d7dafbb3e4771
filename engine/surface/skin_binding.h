#pragma once

#include <span>
#include <vector>

#include "core/column.h"
#include "core/threads.h"
#include "mallow/mesh.h"
#include "surface/picked_vectors.h"
#include "surface/skin_lanes.h"

namespace mallow {

/// Throws ConfigError with what is wrong with a mesh that is to be bound.
void check_skin(const Mesh& mesh);

/// Unit normals at the vertices, from the triangles that meet at their places, by area; (0, 0, 1) where none
/// does.
std::vector<Vec3> vertex_normals(const Mesh& mesh);

/// The particles that carry each vertex, by their number in `particles`, and their weights. spacing: h [m].
/// Throws ConfigError where a vertex is out of reach of all of them.
Column<VertexBinding> bind_vertices(std::span<const Vec3> vertices, const PickedVectors& particles,
                                    float spacing, const Threads& threads);

}  // namespace mallow

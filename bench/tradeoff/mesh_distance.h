#pragma once

#include "mallow/mesh.h"

namespace mallow::bench {

/// How far two surfaces are apart, from the vertices of each to the triangles of the other [m].
struct MeshDistance {
  double mean = 0;       ///< of both ways
  double hausdorff = 0;  ///< the farthest of both ways
};
/// Both meshes have triangles.
MeshDistance mesh_distance(const Mesh& a, const Mesh& b);

}  // namespace mallow::bench

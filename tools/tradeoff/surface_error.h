#pragma once

#include "mallow/mesh.h"

namespace mallow::tradeoff {

/// How far a mesh is from a finer one of the same particles [spacings]: root mean square, over the vertices
/// of both, of the distance to the other near its vertex that is nearest, along the mean of both normals.
/// Where there are none, or they face each other, it is that to the vertex. spacing: h [m], > 0. Infinite where one of the two is empty.
double surface_error(const Mesh& mesh, const Mesh& fine, float spacing, int threads);

}  // namespace mallow::tradeoff

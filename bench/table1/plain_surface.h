#pragma once

#include <span>

#include "mallow/mesh.h"

namespace mallow::bench {

/// The surface as OpenVDB draws it out of the box: a sphere around every particle into a level set, one pass
/// of a Gaussian filter, its mesh. The spheres are as wide as they must be to leave no holes in a lattice,
/// and the mesh is taken as much further in, at the distance from the outermost particles that ours has.
Mesh plain_surface(std::span<const Vec3> positions, float spacing, float particle_radius, double voxel_size,
                   int threads);

}  // namespace mallow::bench

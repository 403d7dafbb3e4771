#pragma once

#include <span>

#include "mallow/mesh.h"

namespace mallow::bench {

/// The surface as OpenVDB draws it out of the box: a sphere around every particle into a level set, one pass
/// of a Gaussian filter, its mesh. The spheres are as wide as they must be to leave no holes in a lattice,
/// which puts the surface a third of a spacing outside of the body. Empty where MALLOW_BENCH_PLAIN_SURFACE is
/// off (bench/CMakeLists.txt).
Mesh plain_surface(std::span<const Vec3> positions, float spacing, double voxel_size, int threads);

}  // namespace mallow::bench

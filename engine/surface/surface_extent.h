#pragma once

#include "mallow/surface.h"
#include "surface/voxel_frame.h"

namespace mallow {

/// The box of all particles and of the surface around them.
struct Extent {
  Eigen::Vector3d low;      ///< of the particles [m]
  double longest_side = 0;  ///< with the surface [m]
};
/// margin: from particles to the surface [m].
Extent extent_of(const SurfaceParticles& particles, double margin);

/// The grid of a surface. Its origin is a corner of a fixed lattice, whole in cubes of BlockMap: voxels,
/// blocks and the order of blocks stay where they are while particles come and go. Throws ConfigError where
/// it would be too large.
VoxelFrame make_frame(const SurfaceConfig& config, float spacing, const Extent& extent);

}  // namespace mallow

#pragma once

#include <cstddef>
#include <vector>

#include "core/raw_columns.h"
#include "surface/surface_lanes.h"

namespace mallow {

/// Points of a block that are `step` voxels apart, from its first voxel on, z fastest; in the unit that
/// `voxel` is the side of a voxel in. step: 1, 2, 4 or 8.
struct VoxelLattice {
  VoxelLattice(int step, float voxel);
  ConstVectors points() const { return {x.data(), y.data(), z.data()}; }

  std::vector<float> x, y, z;
};
/// How many these are.
std::size_t lattice_count(int step);

/// Cubic interpolation (Lagrange) between nodes `step` voxels apart, of which the first lies `before` steps
/// before the first voxel: through the two nodes on each side of a voxel, or the four that are nearest.
NodeWeights cubic_weights(int step, int before);

}  // namespace mallow

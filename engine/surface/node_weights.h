#pragma once

#include "surface/surface_lanes.h"

namespace mallow {

/// Cubic interpolation (Lagrange) between nodes `step` voxels apart, of which the first lies `before` steps
/// before the first voxel: through the two nodes on each side of a voxel, or the four that are nearest.
NodeWeights cubic_weights(int step, int before);

}  // namespace mallow

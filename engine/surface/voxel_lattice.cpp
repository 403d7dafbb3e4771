#include "surface/voxel_lattice.h"

#include <algorithm>
#include <cmath>

namespace mallow {

VoxelLattice::VoxelLattice(int step, float voxel) {
  for (int i = 0; i < k_block_side; i += step)
    for (int j = 0; j < k_block_side; j += step)
      for (int k = 0; k < k_block_side; k += step) {
        x.push_back(static_cast<float>(i) * voxel);
        y.push_back(static_cast<float>(j) * voxel);
        z.push_back(static_cast<float>(k) * voxel);
      }
}

std::size_t lattice_count(int step) {
  const auto side = static_cast<std::size_t>(k_block_side / step);
  return side * side * side;
}

NodeWeights cubic_weights(int step, int before) {
  NodeWeights weights{};
  constexpr int k_last = static_cast<int>(k_nodes) - 1;
  for (int v = 0; v < k_block_side; ++v) {
    const double t = static_cast<double>(v) / step + before;
    const int first = std::clamp(static_cast<int>(std::floor(t)) - 1, 0, k_last - 3);
    for (int n = first; n < first + 4; ++n) {
      double w = 1;
      for (int m = first; m < first + 4; ++m)
        if (m != n) w *= (t - m) / (n - m);
      weights.w[v][n] = static_cast<float>(w);
    }
  }
  return weights;
}

}  // namespace mallow

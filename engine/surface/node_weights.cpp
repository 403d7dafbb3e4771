#include "surface/node_weights.h"

#include <algorithm>
#include <cmath>

namespace mallow {

NodeWeights cubic_weights(int step, int before) {
  NodeWeights weights{};
  weights.step = step;
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

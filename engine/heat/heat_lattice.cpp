#include "heat/heat_lattice.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mallow {

HeatLattice heat_lattice(double support_radius, double spacing) {
  constexpr double k_dense = 64;  // spacings: beyond, a lattice is as good as a continuum
  const double sigma = std::min(support_radius / spacing, k_dense);
  const int reach = static_cast<int>(std::ceil(sigma));
  std::vector<double> layer(static_cast<std::size_t>(reach) + 1, 0);  // Σ w of the layer s away
  for (int s = 0; s <= reach; ++s)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        const double q2 = (x * x + y * y + s * s) / (sigma * sigma);
        if (q2 < 1 && (x != 0 || y != 0 || s != 0)) layer[static_cast<std::size_t>(s)] += (1 - q2) * (1 - q2);
      }
  double moment = 0, total = layer[0];
  for (std::size_t s = 1; s < layer.size(); ++s) {
    moment += static_cast<double>(s * s) * layer[s];
    total += 2 * layer[s];
  }
  HeatLattice lattice;
  if (!(moment > 0)) return lattice;  // nobody has neighbours
  lattice.factor = static_cast<float>(1 / moment);
  lattice.total = static_cast<float>(total / moment);
  double missing = 0.5 * (total - layer[0]), exposure = 0, resistance = 0;
  for (std::size_t l = 0; l + 1 < layer.size(); ++l) {
    exposure += static_cast<double>(exposed_share(static_cast<float>(1 - missing / total)));
    missing -= layer[l + 1];
    double through = 0;  // between layers l and l + 1
    for (std::size_t s = 1; s < layer.size(); ++s)
      through += layer[s] * static_cast<double>(s * std::min(s, l + 1));
    resistance += moment / through - 1;
  }
  lattice.exposure = static_cast<float>(exposure);
  lattice.resistance = static_cast<float>(resistance);
  return lattice;
}

}  // namespace mallow

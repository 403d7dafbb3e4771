#include "heat/heat_lattice.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mallow {
namespace {

/// Sums over the layers of a lattice, by how far they are away [h].
struct Layers {
  std::vector<double> conducts;  ///< Σ w
  std::vector<double> along;     ///< Σ w x²
  std::vector<double> density;   ///< Σ of the kernel of densities, up to a factor

  Layers(DensityKernel of_densities, double sigma) {
    const int reach = static_cast<int>(std::ceil(sigma));
    for (int s = 0; s <= reach; ++s) {
      double w = 0, moment = 0, kernel = 0;
      for (int y = -reach; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x) {
          const double q2 = (x * x + y * y + s * s) / (sigma * sigma), q = std::min(std::sqrt(q2), 1.0);
          const double t = std::max(0.0, 1 - q2);
          kernel += of_densities == DensityKernel::poly6 ? t * t * t : std::pow(1 - q, 4) * (1 + 4 * q);
          if (x == 0 && y == 0 && s == 0) continue;
          w += t * t;
          moment += t * t * x * x;
        }
      conducts.push_back(w);
      along.push_back(moment);
      density.push_back(kernel);
    }
  }
  /// The share of a sum that layer l below a face has.
  static double share(const std::vector<double>& sums, std::size_t l) {
    double all = -sums[0], missing = 0;
    for (std::size_t s = 0; s < sums.size(); ++s) all += 2 * sums[s];
    for (std::size_t s = l + 1; s < sums.size(); ++s) missing += sums[s];
    return 1 - missing / all;
  }
};

}  // namespace

HeatLattice heat_lattice(DensityKernel of_densities, double support_radius, double spacing) {
  constexpr double k_dense = 64;  // spacings: beyond, a lattice is as good as a continuum
  const Layers layers(of_densities, std::min(support_radius / spacing, k_dense));
  const std::size_t reach = layers.conducts.size();
  double moment = 0;
  for (std::size_t s = 1; s < reach; ++s) moment += static_cast<double>(s * s) * layers.conducts[s];
  HeatLattice lattice;
  if (!(moment > 0)) return lattice;  // nobody has neighbours
  lattice.factor = static_cast<float>(1 / moment);
  const double face = Layers::share(layers.density, 0);
  lattice.open = static_cast<float>((1 / Layers::share(layers.along, 0) - 1) / (1 / face - 1));
  const auto counts = [&](std::size_t l) {
    return static_cast<double>(openness(lattice, static_cast<float>(Layers::share(layers.density, l))));
  };
  double exposure = 0, resistance = 0;
  for (std::size_t l = 0; l < 2 * reach; ++l) {
    exposure += static_cast<double>(exposed_share(static_cast<float>(Layers::share(layers.density, l))));
    double through = 0;  // of pairs of layers a and a + s, between l and l + 1
    for (std::size_t s = 1; s < reach; ++s)
      for (std::size_t a = l + 1 > s ? l + 1 - s : 0; a <= l; ++a)
        through += layers.conducts[s] * static_cast<double>(s) * 0.5 * (counts(a) + counts(a + s));
    resistance += moment / through - 1;
  }
  lattice.exposure = static_cast<float>(exposure);
  lattice.resistance = static_cast<float>(resistance);
  return lattice;
}

}  // namespace mallow

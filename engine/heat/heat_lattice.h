#pragma once

#include "sph/kernel_functions.h"

namespace mallow {

/// What sums over pairs make of a cubic lattice, by which they are corrected: then heat flows through it as
/// through what it stands for. All in units of the spacing h.
///
/// The flow between two particles is κ h C (1 − r²/σ²)² (T_j − T_i) [W], the pairs of Cleary & Monaghan 1999
/// with the gradient of the poly6 kernel over r, for volumes h³: where T is linear they cancel, where it is
/// quadratic Σ C w x² = 2 makes them the Laplacian.
struct HeatLattice {
  float factor = 0;  ///< C
  /// At a surface pairs are missing, and without them less heat goes along it: pairs count the mean of
  /// 1 + open (ρ0/ρ − 1) of their two times, with which as much goes along a flat face as within.
  float open = 0;
  float exposure = 0;  ///< sum over the layers below a flat face of exposed_share()
  /// Between a flat face and the layers below it heat goes through as much more matter, or less [h].
  float resistance = 0;
};
HeatLattice heat_lattice(DensityKernel of_densities, double support_radius, double spacing);

/// How much more pairs of a particle count. density: over that at rest.
inline float openness(const HeatLattice& lattice, float density) {
  constexpr float k_most = 3;  // in a drop of few particles
  const float lacks = 1 / density - 1;
  return 1 + lattice.open * (lacks > 0 ? (lacks < k_most ? lacks : k_most) : 0.0f);
}

/// What a particle lacks of the density at rest, less what irregular particles lack anywhere.
inline float exposed_share(float density) {
  constexpr float k_irregular = 0.1f;
  const float lacks = 1 - k_irregular - density;
  return lacks > 0 ? lacks : 0.0f;
}

}  // namespace mallow

#pragma once

namespace mallow {

/// What sums over pairs make of a cubic lattice, by which they are corrected: then heat flows through it as
/// through what it stands for. All in units of the spacing h.
///
/// The flow between two particles is κ h C (1 − r²/σ²)² (T_j − T_i) [W], the pairs of Cleary & Monaghan 1999
/// with the gradient of the poly6 kernel over r, for volumes h³: where T is linear they cancel, where it is
/// quadratic Σ C w x² = 2 makes them the Laplacian.
struct HeatLattice {
  float factor = 0;    ///< C
  float total = 0;     ///< Σ C w of a particle within
  float exposure = 0;  ///< sum over the layers below a flat face of what exposed_share() says of them
  /// Of layers beside a face pairs that reach over them are missing: heat goes through as much more matter
  /// [h].
  float resistance = 0;
};
HeatLattice heat_lattice(double support_radius, double spacing);

/// What a particle lacks of the sum that it would have within, less what irregular particles lack anywhere.
inline float exposed_share(float sum_over_total) {
  constexpr float k_irregular = 0.1f;
  const float lacks = 1 - k_irregular - sum_over_total;
  return lacks > 0 ? lacks : 0.0f;
}

}  // namespace mallow

#pragma once

namespace mallow {

/// Normalising factors of the smoothing kernels for support radius σ, for use with q = r/σ in [0, 1]; the
/// powers of σ are taken out in double, so that scenes of any unit stay inside single precision.
struct KernelFactors {
  float density;         ///< poly6: W = density (1 − q²)³ [1/m³]. [TK eq. 3]
  float spiky_gradient;  ///< |∇W| = spiky_gradient (1 − q)² [1/m⁴]. Desbrun's spiky kernel, Mueller 2003
  float viscosity;       ///< ∇²W = viscosity (1 − q) [1/m⁵]. Mueller 2003
  float poly6_gradient;   ///< ∇W = −poly6_gradient (1 − q²)² (x_i − x_j) [1/m⁵]
  float poly6_laplacian;  ///< ∇²W = −poly6_laplacian (1 − q²)(3 − 7q²) [1/m⁵]
};
KernelFactors kernel_factors(double support_radius);

/// What a half space behind a plane at distance q σ, q in [0, 1], holds of a kernel: the share of poly6, and
/// σ |∇| of the spiky kernel's, which is σ times the integral of W over the plane. [Koschier & Bender 2017]
float half_space_share(float q);
float half_space_gradient(float q);
/// The same of Wendland's C2 kernel, W = 21/(2 π σ³) (1 − q)⁴ (1 + 4 q), and minus its slope. [Wendland 1995]
float wendland_half_space_share(float q);
float wendland_half_space_slope(float q);

/// Σ W over an infinite cubic lattice of the given spacing, a point at the origin included [1/m³]: a full
/// interior of unit masses has this density, which is what rest density follows from.
double lattice_density(double support_radius, double spacing);
/// Of Wendland's C2 kernel there: Σ (1 − q)⁴ (1 + 4 q), and Σ r² (1 − q)⁶, of the squares of its gradients
/// [m²].
double wendland_lattice_sum(double support_radius, double spacing);
double wendland_lattice_squares(double support_radius, double spacing);

}  // namespace mallow

#pragma once

namespace mallow {

/// That of densities: poly6 as in the paper, or Wendland's C2, W = 21/(2 π σ³) (1 − q)⁴ (1 + 4 q), where
/// volume is kept. Held to their volume by poly6, particles of what flows gathered in pairs and then in
/// heaps, the more the more iterations: with 8, half of a pool was within 0.16 spacings of another, with
/// Wendland's 0.92. So does any kernel whose Fourier transform goes below 0. [Wendland 1995] [Dehnen & Aly
/// 2012]
enum class DensityKernel { poly6, wendland };

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

/// What a half space behind a plane at distance q σ, q in [0, 1], holds of a kernel: the share of that of
/// densities, and σ |∇| of the spiky kernel's, which is σ times the integral of W over the plane. [Koschier &
/// Bender 2017]
float half_space_share(DensityKernel kernel, float q);
float half_space_gradient(float q);
/// Minus the slope of half_space_share() of Wendland's kernel.
float wendland_half_space_slope(float q);

/// Σ W over an infinite cubic lattice of the given spacing, a point at the origin included [1/m³]: a full
/// interior of unit masses has this density, which is what rest density follows from.
double lattice_density(double support_radius, double spacing);
/// Of Wendland's kernel there: Σ (1 − q)⁴ (1 + 4 q), and Σ r² (1 − q)⁶, of the squares of its gradients
/// [m²].
double wendland_lattice_sum(double support_radius, double spacing);
double wendland_lattice_squares(double support_radius, double spacing);

}  // namespace mallow

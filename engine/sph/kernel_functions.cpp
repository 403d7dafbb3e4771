#include "sph/kernel_functions.h"

#include <cmath>
#include <numbers>

namespace mallow {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr double k_dense = 64;  // spacings

/// Σ of term(q²) over the lattice points within a support radius.
template <class Term>
double lattice_sum(double support_radius, double spacing, const Term& term) {
  const int reach = static_cast<int>(std::ceil(support_radius / spacing));
  const double square = support_radius * support_radius;
  double sum = 0;
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x)
        if (const double q2 = spacing * spacing * (x * x + y * y + z * z) / square; q2 < 1) sum += term(q2);
  return sum;
}

}  // namespace

KernelFactors kernel_factors(double support_radius) {
  const double s3 = support_radius * support_radius * support_radius;
  const double s4 = s3 * support_radius, s5 = s4 * support_radius;
  return {
      .density = static_cast<float>(315.0 / (64.0 * k_pi * s3)),
      .spiky_gradient = static_cast<float>(45.0 / (k_pi * s4)),
      .viscosity = static_cast<float>(45.0 / (k_pi * s5)),
      .poly6_gradient = static_cast<float>(945.0 / (32.0 * k_pi * s5)),
      .poly6_laplacian = static_cast<float>(945.0 / (32.0 * k_pi * s5)),
  };
}

namespace {

float poly6_half_space_share(float q) {
  // W over a plane at z is 315/(256 σ) (1 − z²)⁴, z in σ; its integral from q to 1.
  const float q2 = q * q;
  return 0.5f - 315.0f / 256 * q * (1 - q2 * (4.0f / 3 - q2 * (6.0f / 5 - q2 * (4.0f / 7 - q2 / 9))));
}

float wendland_half_space_share(float q) {
  const float t = 1 - q, t2 = t * t;
  return t2 * t2 * t2 * (3.5f - t * (4.5f - 1.5f * t));
}

}  // namespace

float half_space_share(DensityKernel kernel, float q) {
  return kernel == DensityKernel::wendland ? wendland_half_space_share(q) : poly6_half_space_share(q);
}

float half_space_gradient(float q) {
  const float t = 1 - q;
  return t * t * t * t * (7.5f - 6 * t);
}

float wendland_half_space_slope(float q) {
  // W over a plane at z is 21/σ ∫ (1 − q)⁴ (1 + 4 q) q dq from z to 1.
  const float t = 1 - q, t2 = t * t;
  return t2 * t2 * t * (21 - t * (31.5f - 12 * t));
}

double lattice_density(double support_radius, double spacing) {
  const double s = support_radius;
  // Farther, the sum is the integral of W, 1, to single precision, and would take minutes for thousands of
  // spacings.
  if (s > k_dense * spacing) return 1 / (spacing * spacing * spacing);
  const double sum = lattice_sum(s, spacing, [](double q2) { return (1 - q2) * (1 - q2) * (1 - q2); });
  return 315.0 / (64.0 * k_pi * s * s * s) * sum;
}

double wendland_lattice_sum(double support_radius, double spacing) {
  if (support_radius > k_dense * spacing) return 2 * k_pi / 21 * std::pow(support_radius / spacing, 3);
  return lattice_sum(support_radius, spacing, [](double q2) {
    const double q = std::sqrt(q2);
    return std::pow(1 - q, 4) * (1 + 4 * q);
  });
}

double wendland_lattice_squares(double support_radius, double spacing) {
  const double square = support_radius * support_radius;
  // The integral, 4 π ∫ (1 − q)⁶ q⁴ dq.
  if (support_radius > k_dense * spacing)
    return square * 2 * k_pi / 1155 * std::pow(support_radius / spacing, 3);
  return square *
         lattice_sum(support_radius, spacing, [](double q2) { return q2 * std::pow(1 - std::sqrt(q2), 6); });
}

}  // namespace mallow

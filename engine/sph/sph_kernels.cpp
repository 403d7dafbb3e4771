// SPH sums of model section 1: Mueller, Charypar & Gross 2003 in pairwise form, and [TK eq. 1, 2] as printed.
// Departs from [TK]: densities sum rest volumes, so that a light body is not pushed off by heavy neighbours
// (Solenthaler & Pajarola 2008); pressure and viscosity are antisymmetric, so that momentum is kept.
#include "sph/sph_kernels.h"

namespace mallow::MALLOW_LEVEL {
namespace {

void density(const SphInput& in, std::size_t begin, std::size_t end, float* rho, float* pressure,
             float* volume, float* rho_by_row) noexcept {
  for (std::size_t i = begin; i < end; ++i) {
    const float x = in.position.x[i], y = in.position.y[i], z = in.position.z[i];
    const std::uint32_t* const list = in.indices + in.list_begin[i];
    const std::uint32_t n = in.list_count[i];
    float sum = 0;
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t j = list[k];
      const float dx = (x - in.position.x[j]) * in.inverse_radius;
      const float dy = (y - in.position.y[j]) * in.inverse_radius;
      const float dz = (z - in.position.z[j]) * in.inverse_radius;
      const float q2 = dx * dx + dy * dy + dz * dz;
      const float t = q2 < 1.0f ? 1.0f - q2 : 0.0f;
      const float w = t * t * t;
      sum += in.group ? in.groups[in.group[j]].rest_volume * w : w;
    }
    const SphGroup& own = in.groups[in.group ? in.group[i] : 0];
    if (!in.group) sum *= own.rest_volume;
    rho[i] = own.rest_density * (in.density_factor * sum);
    const float p = own.pressure_coefficient * (rho[i] - own.rest_density);
    pressure[i] = p < 0 ? p * own.cohesion : p;
    volume[i] = own.mass / rho[i];
    rho_by_row[in.row_of[i]] = rho[i];
  }
}

struct Sum {
  float x = 0, y = 0, z = 0;
};

/// Pressure along x_i − x_j and viscosity of one pair, each per volume of j. Model 1, Mueller 2003.
struct ConservativePair {
  static constexpr bool relative_velocity = true;

  static float push(const SphInput& in, float r2, float own_pressure, float pressure) {
    const float r = __builtin_sqrtf(r2);
    const float t = falloff(in, r);
    // Coincident particles have no direction to push each other in.
    return r > 0 ? 0.5f * (own_pressure + pressure) * in.spiky_gradient * t * t / r : 0.0f;
  }
  static float drag(const SphInput& in, float r2) { return in.viscosity * falloff(in, __builtin_sqrtf(r2)); }

 private:
  static float falloff(const SphInput& in, float r) {
    const float q = r * in.inverse_radius;
    return q < 1.0f ? 1.0f - q : 0.0f;
  }
};

/// The same as [TK eq. 1, 2] print it.
struct PrintedPair {
  static constexpr bool relative_velocity = false;

  static float push(const SphInput& in, float r2, float, float pressure) {
    const float t = falloff(in, r2);
    return pressure * in.poly6_gradient * t * t;
  }
  static float drag(const SphInput& in, float r2) {
    const float q2 = r2 * in.inverse_radius * in.inverse_radius;
    return -in.poly6_laplacian * falloff(in, r2) * (3.0f - 7.0f * q2);
  }

 private:
  static float falloff(const SphInput& in, float r2) {
    const float q2 = r2 * in.inverse_radius * in.inverse_radius;
    return q2 < 1.0f ? 1.0f - q2 : 0.0f;
  }
};

/// One particle's sums over its pairs within its group and with others.
template <class Pair, bool viscous, bool grouped>
void sum_pairs(const SphInput& in, std::size_t i, const float* pressure, const float* volume, Sum& same,
               Sum& cross) {
  const float x = in.position.x[i], y = in.position.y[i], z = in.position.z[i];
  const std::uint32_t* const list = in.indices + in.list_begin[i];
  const std::uint32_t n = in.list_count[i];
  const std::uint32_t own = grouped ? in.group[i] : 0;
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t j = list[k];
    const float dx = x - in.position.x[j], dy = y - in.position.y[j], dz = z - in.position.z[j];
    const float r2 = dx * dx + dy * dy + dz * dz;
    const float push = volume[j] * Pair::push(in, r2, pressure[i], pressure[j]);
    float ax = push * dx, ay = push * dy, az = push * dz;
    const std::uint32_t other = grouped ? in.group[j] : own;
    if (viscous) {
      const float mu = other == own ? in.groups[own].viscosity
                                    : 0.5f * (in.groups[own].viscosity + in.groups[other].viscosity);
      const float drag = volume[j] * mu * Pair::drag(in, r2);
      ax += drag * (Pair::relative_velocity ? in.velocity.x[j] - in.velocity.x[i] : in.velocity.x[j]);
      ay += drag * (Pair::relative_velocity ? in.velocity.y[j] - in.velocity.y[i] : in.velocity.y[j]);
      az += drag * (Pair::relative_velocity ? in.velocity.z[j] - in.velocity.z[i] : in.velocity.z[j]);
    }
    Sum& sum = other == own ? same : cross;
    sum.x += ax;
    sum.y += ay;
    sum.z += az;
  }
}

template <class Pair, bool viscous, bool grouped>
void sum_block(const SphInput& in, std::size_t begin, std::size_t end, const float* rho,
               const float* pressure, const float* volume, const Vectors& same, const Vectors& cross) {
  for (std::size_t i = begin; i < end; ++i) {
    Sum own, other;
    sum_pairs<Pair, viscous, grouped>(in, i, pressure, volume, own, other);
    const std::uint32_t row = in.row_of[i];
    same.x[row] = own.x / rho[i];
    same.y[row] = own.y / rho[i];
    same.z[row] = own.z / rho[i];
    if (grouped) {
      cross.x[row] = other.x / rho[i];
      cross.y[row] = other.y / rho[i];
      cross.z[row] = other.z / rho[i];
    }
  }
}

template <class Pair>
void accelerations(const SphInput& in, std::size_t begin, std::size_t end, const float* rho,
                   const float* pressure, const float* volume, Vectors same, Vectors cross) noexcept {
  const bool viscous = in.velocity.x != nullptr, grouped = in.group != nullptr;
  const auto run = viscous ? (grouped ? sum_block<Pair, true, true> : sum_block<Pair, true, false>)
                           : (grouped ? sum_block<Pair, false, true> : sum_block<Pair, false, false>);
  run(in, begin, end, rho, pressure, volume, same, cross);
}

}  // namespace

extern const SphKernels sph_kernels;
const SphKernels sph_kernels = {density, accelerations<ConservativePair>, accelerations<PrintedPair>};

}  // namespace mallow::MALLOW_LEVEL

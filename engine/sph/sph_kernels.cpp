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

/// One particle's sum over its pairs; `select` true: only pairs whose groups are equal (same) or differ
/// (cross).
template <bool viscous, bool grouped>
void conservative_pairs(const SphInput& in, std::size_t i, const float* pressure, const float* volume,
                        Sum& same, Sum& cross) {
  const float x = in.position.x[i], y = in.position.y[i], z = in.position.z[i];
  const std::uint32_t* const list = in.indices + in.list_begin[i];
  const std::uint32_t n = in.list_count[i];
  const std::uint32_t own = grouped ? in.group[i] : 0;
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t j = list[k];
    const float dx = x - in.position.x[j], dy = y - in.position.y[j], dz = z - in.position.z[j];
    const float r2 = dx * dx + dy * dy + dz * dz;
    const float r = __builtin_sqrtf(r2);
    const float q = r * in.inverse_radius;
    const float t = q < 1.0f ? 1.0f - q : 0.0f;
    // Coincident particles have no direction to push each other in.
    const float push =
        r > 0 ? volume[j] * 0.5f * (pressure[i] + pressure[j]) * in.spiky_gradient * t * t / r : 0.0f;
    float ax = push * dx, ay = push * dy, az = push * dz;
    const bool is_same = !grouped || in.group[j] == own;
    if (viscous) {
      const float mu =
          is_same ? in.groups[own].viscosity
                  : 0.5f * (in.groups[own].viscosity + in.groups[grouped ? in.group[j] : 0].viscosity);
      const float drag = volume[j] * mu * in.viscosity * t;
      ax += drag * (in.velocity.x[j] - in.velocity.x[i]);
      ay += drag * (in.velocity.y[j] - in.velocity.y[i]);
      az += drag * (in.velocity.z[j] - in.velocity.z[i]);
    }
    Sum& sum = is_same ? same : cross;
    sum.x += ax;
    sum.y += ay;
    sum.z += az;
  }
}

template <bool viscous, bool grouped>
void printed_pairs(const SphInput& in, std::size_t i, const float* pressure, const float* volume, Sum& same,
                   Sum& cross) {
  const float x = in.position.x[i], y = in.position.y[i], z = in.position.z[i];
  const std::uint32_t* const list = in.indices + in.list_begin[i];
  const std::uint32_t n = in.list_count[i];
  const std::uint32_t own = grouped ? in.group[i] : 0;
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t j = list[k];
    const float dx = x - in.position.x[j], dy = y - in.position.y[j], dz = z - in.position.z[j];
    const float q2 = (dx * dx + dy * dy + dz * dz) * in.inverse_radius * in.inverse_radius;
    const float t = q2 < 1.0f ? 1.0f - q2 : 0.0f;
    const float push = volume[j] * pressure[j] * in.poly6_gradient * t * t;
    float ax = push * dx, ay = push * dy, az = push * dz;
    const bool is_same = !grouped || in.group[j] == own;
    if (viscous) {
      const float mu =
          is_same ? in.groups[own].viscosity
                  : 0.5f * (in.groups[own].viscosity + in.groups[grouped ? in.group[j] : 0].viscosity);
      const float drag = -volume[j] * mu * in.poly6_laplacian * t * (3.0f - 7.0f * q2);
      ax += drag * in.velocity.x[j];
      ay += drag * in.velocity.y[j];
      az += drag * in.velocity.z[j];
    }
    Sum& sum = is_same ? same : cross;
    sum.x += ax;
    sum.y += ay;
    sum.z += az;
  }
}

template <auto pairs, bool grouped>
void accelerations(const SphInput& in, std::size_t begin, std::size_t end, const float* rho,
                   const float* pressure, const float* volume, const Vectors& same, const Vectors& cross) {
  for (std::size_t i = begin; i < end; ++i) {
    Sum own, other;
    pairs(in, i, pressure, volume, own, other);
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

void conservative(const SphInput& in, std::size_t begin, std::size_t end, const float* rho,
                  const float* pressure, const float* volume, Vectors same, Vectors cross) noexcept {
  const bool viscous = in.velocity.x != nullptr;
  if (in.group)
    viscous ? accelerations<conservative_pairs<true, true>, true>(in, begin, end, rho, pressure, volume, same,
                                                                  cross)
            : accelerations<conservative_pairs<false, true>, true>(in, begin, end, rho, pressure, volume,
                                                                   same, cross);
  else
    viscous ? accelerations<conservative_pairs<true, false>, false>(in, begin, end, rho, pressure, volume,
                                                                    same, cross)
            : accelerations<conservative_pairs<false, false>, false>(in, begin, end, rho, pressure, volume,
                                                                     same, cross);
}

void printed(const SphInput& in, std::size_t begin, std::size_t end, const float* rho, const float* pressure,
             const float* volume, Vectors same, Vectors cross) noexcept {
  const bool viscous = in.velocity.x != nullptr;
  if (in.group)
    viscous
        ? accelerations<printed_pairs<true, true>, true>(in, begin, end, rho, pressure, volume, same, cross)
        : accelerations<printed_pairs<false, true>, true>(in, begin, end, rho, pressure, volume, same, cross);
  else
    viscous
        ? accelerations<printed_pairs<true, false>, false>(in, begin, end, rho, pressure, volume, same, cross)
        : accelerations<printed_pairs<false, false>, false>(in, begin, end, rho, pressure, volume, same,
                                                            cross);
}

}  // namespace

extern const SphKernels sph_kernels;
const SphKernels sph_kernels = {density, conservative, printed};

}  // namespace mallow::MALLOW_LEVEL

// Sums in double: what the rigid frame of a group and the moments of its regions are found from.
#include "shape_matching/moment_kernels.h"

namespace mallow::MALLOW_LEVEL {
namespace {

constexpr std::size_t k_wide = 8;
using Doubles = double __attribute__((vector_size(k_wide * sizeof(double))));
using Floats = float __attribute__((vector_size(k_wide * sizeof(float))));

/// Not returned: registers this wide are no part of the lower levels' calls.
void load(const float* values, Doubles& lanes) {
  Floats floats;
  __builtin_memcpy(&floats, values, sizeof floats);
  lanes = __builtin_convertvector(floats, Doubles);
}

double sum(const Doubles& lanes) {
  double total = 0;
  for (std::size_t l = 0; l < k_wide; ++l) total += lanes[l];
  return total;
}

void frame_sums(ConstVectors position, ConstVectors reference, const double* origin, std::size_t begin,
                std::size_t end, double* sums) noexcept {
  const float* const positions[3] = {position.x, position.y, position.z};
  for (std::size_t a = 0; a < 3; ++a) {
    const float* const x = positions[a];
    Doubles xx = {}, xy = {}, xz = {}, first = {};
    std::size_t i = begin;
    for (; i + k_wide <= end; i += k_wide) {
      Doubles d, rx, ry, rz;
      load(x + i, d);
      load(reference.x + i, rx);
      load(reference.y + i, ry);
      load(reference.z + i, rz);
      d -= origin[a];
      xx += d * rx;
      xy += d * ry;
      xz += d * rz;
      first += d;
    }
    double* const row = sums + 3 * a;
    row[0] = sum(xx), row[1] = sum(xy), row[2] = sum(xz), sums[9 + a] = sum(first);
    for (; i < end; ++i) {
      const double d = static_cast<double>(x[i]) - origin[a];
      row[0] += d * static_cast<double>(reference.x[i]);
      row[1] += d * static_cast<double>(reference.y[i]);
      row[2] += d * static_cast<double>(reference.z[i]);
      sums[9 + a] += d;
    }
  }
}

void write_rows(ConstVectors reference, const float* weight, std::size_t begin, std::size_t end,
                double* rows) noexcept {
  for (std::size_t i = begin; i < end; ++i) {
    double* const row = rows + i * k_moment_row;
    const double w = static_cast<double>(weight[i]), x = static_cast<double>(reference.x[i]),
                 y = static_cast<double>(reference.y[i]), z = static_cast<double>(reference.z[i]);
    const double wx = w * x, wy = w * y, wz = w * z;
    row[0] = w, row[1] = wx, row[2] = wy, row[3] = wz;
    row[4] = wx * x, row[5] = wy * y, row[6] = wz * z;
    row[7] = wy * z, row[8] = wx * z, row[9] = wx * y;
    row[10] = row[11] = 0;
  }
}

using Part = double __attribute__((vector_size(4 * sizeof(double)), may_alias));
constexpr std::size_t k_parts = k_moment_row / 4;

void sum_runs(const double* rows, const Run* runs, std::size_t count, double* out) noexcept {
  // Two sums in a fixed order hide the latency of the addition.
  Part a[k_parts] = {}, b[k_parts] = {};
  for (std::size_t r = 0; r < count; ++r) {
    const Part* row = reinterpret_cast<const Part*>(rows + runs[r].first * k_moment_row);
    std::uint32_t k = 0;
    for (; k + 2 <= runs[r].count; k += 2, row += 2 * k_parts)
      for (std::size_t p = 0; p < k_parts; ++p) {
        a[p] += row[p];
        b[p] += row[k_parts + p];
      }
    if (k < runs[r].count)
      for (std::size_t p = 0; p < k_parts; ++p) a[p] += row[p];
  }
  for (std::size_t p = 0; p < k_parts; ++p) {
    const Part both = a[p] + b[p];
    for (std::size_t l = 0; l < 4; ++l) out[4 * p + l] = both[l];
  }
}

}  // namespace

extern const MomentKernels moment_kernels;
const MomentKernels moment_kernels = {frame_sums, write_rows, sum_runs};

}  // namespace mallow::MALLOW_LEVEL

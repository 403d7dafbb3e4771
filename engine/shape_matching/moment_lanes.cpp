// Sums in double: what the rigid frame of a body and the moments of its regions are found from.
#include "shape_matching/moment_lanes.h"

#include "core/double_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

void frame_sums(ConstVectors position, ConstVectors reference, const double* origin, std::size_t begin,
                std::size_t end, double* sums) noexcept {
  sum_rows<12>(
      begin, end,
      [&](const auto& get, auto* s) {
        const auto x = get(position.x) - origin[0], y = get(position.y) - origin[1],
                   z = get(position.z) - origin[2];
        const auto rx = get(reference.x), ry = get(reference.y), rz = get(reference.z);
        s[0] += x * rx, s[1] += x * ry, s[2] += x * rz;
        s[3] += y * rx, s[4] += y * ry, s[5] += y * rz;
        s[6] += z * rx, s[7] += z * ry, s[8] += z * rz;
        s[9] += x, s[10] += y, s[11] += z;
      },
      sums);
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

/// Doubles of a row at a time: a register, of the levels whose registers divide the row.
constexpr std::size_t k_part = k_doubles < 4 ? k_doubles : 4;
constexpr std::size_t k_parts = k_moment_row / k_part;
using Part = VectorOf<double, k_part>;

inline Part load_part(const double* values) {
  Part part;
  copy_bytes(&part, values, sizeof part);
  return part;
}

void sum_runs(const double* rows, const Run* runs, std::size_t count, double* out) noexcept {
  // Two sums in a fixed order hide the latency of the addition.
  Part a[k_parts], b[k_parts];
  for (std::size_t p = 0; p < k_parts; ++p) a[p] = b[p] = Part{};  // "= {}" GCC 12 takes for memory
  for (std::size_t r = 0; r < count; ++r) {
    const double* row = rows + runs[r].first * k_moment_row;
    std::uint32_t k = 0;
    for (; k + 2 <= runs[r].count; k += 2, row += 2 * k_moment_row)
      for (std::size_t p = 0; p < k_parts; ++p) {
        a[p] += load_part(row + p * k_part);
        b[p] += load_part(row + k_moment_row + p * k_part);
      }
    if (k < runs[r].count)
      for (std::size_t p = 0; p < k_parts; ++p) a[p] += load_part(row + p * k_part);
  }
  for (std::size_t p = 0; p < k_parts; ++p) {
    const Part both = a[p] + b[p];
    copy_bytes(out + p * k_part, &both, sizeof both);
  }
}

}  // namespace

extern const MomentLanes moment_lanes;
const MomentLanes moment_lanes = {frame_sums, write_rows, sum_runs};

}  // namespace mallow::MALLOW_LEVEL

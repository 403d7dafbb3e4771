// Region sums, rotations and goal positions of model section 2: [TK eq. 7] with the weights of Rivers & James
// 2007, which keep momentum exactly. Departs from [TK]: region centres c̄_j stand where the print has x̄_j.
#include "shape_matching/shape_kernels.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// u_i: what is left of a position when the group's rigid motion is taken out.
void displacement(const ShapeInput& in, std::size_t i, float* u) {
  const float* const r = in.frame_rotation;
  const float x = in.reference.x[i], y = in.reference.y[i], z = in.reference.z[i];
  u[0] = (in.position.x[i] - in.frame_translation[0]) - (r[0] * x + r[1] * y + r[2] * z);
  u[1] = (in.position.y[i] - in.frame_translation[1]) - (r[3] * x + r[4] * y + r[5] * z);
  u[2] = (in.position.z[i] - in.frame_translation[2]) - (r[6] * x + r[7] * y + r[8] * z);
}

void write_rows(const ShapeInput& in, std::size_t begin, std::size_t end, float* rows) noexcept {
  for (std::size_t i = begin; i < end; ++i) {
    float* const row = rows + (i - begin) * k_row;
    const float x = in.reference.x[i], y = in.reference.y[i], z = in.reference.z[i];
    float u[3];
    displacement(in, i, u);
    for (int a = 0; a < 3; ++a) {
      const float wu = in.weight[i] * u[a];
      row[3 * a] = wu * x;
      row[3 * a + 1] = wu * y;
      row[3 * a + 2] = wu * z;
      row[9 + a] = wu;
    }
  }
}

/// The widest registers of the level. Rows are added in them by name: left to itself GCC 12 keeps half of the
/// accumulators below in single floats at AVX2 and AVX-512, four times as slow.
#if defined(__AVX512F__)
constexpr std::size_t k_width = 16;
#elif defined(__AVX__)
constexpr std::size_t k_width = 8;
#else
constexpr std::size_t k_width = 4;
#endif
constexpr std::size_t k_parts = k_row / k_width;
using Part = float __attribute__((vector_size(k_width * sizeof(float)), may_alias));

void add_row(const float* rows, std::uint32_t i, Part* sum) {
  const Part* const row = reinterpret_cast<const Part*>(rows + static_cast<std::size_t>(i) * k_row);
  for (std::size_t p = 0; p < k_parts; ++p) sum[p] += row[p];
}

/// Adds the rows of a list. Four accumulators in a fixed order hide the latency of the addition. sum: on a
/// 64-byte boundary, as rows are.
void sum_rows(const float* rows, const RegionLists& lists, std::size_t which, float* sum) {
  const std::uint32_t* const list = lists.entries + lists.begin[which];
  const std::uint32_t n = lists.count[which];
  Part a[k_parts] = {}, b[k_parts] = {}, c[k_parts] = {}, d[k_parts] = {};
  std::uint32_t k = 0;
  for (; k + 4 <= n; k += 4) {
    if (lists.prefetch)
      for (std::uint32_t ahead = k + k_prefetch; ahead < k + k_prefetch + 4; ++ahead)
        __builtin_prefetch(rows + static_cast<std::size_t>(list[ahead]) * k_row);
    add_row(rows, list[k], a);
    add_row(rows, list[k + 1], b);
    add_row(rows, list[k + 2], c);
    add_row(rows, list[k + 3], d);
  }
  for (; k < n; ++k) add_row(rows, list[k], a);
  for (std::size_t p = 0; p < k_parts; ++p) reinterpret_cast<Part*>(sum)[p] = (a[p] + b[p]) + (c[p] + d[p]);
}

void sum_runs(const float* rows, std::size_t count, const RunLengths& lengths, std::size_t all,
              float* table) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    Part sum[k_parts] = {};
    const Part* row = reinterpret_cast<const Part*>(rows + i * k_row);
    Part* entry = reinterpret_cast<Part*>(table + i * k_row);
    std::uint32_t length = 0;
    for (std::uint32_t level = 0; level < lengths.levels; ++level, entry += all * k_parts) {
      for (; length < lengths.length[level]; ++length, row += k_parts)
        for (std::size_t p = 0; p < k_parts; ++p) sum[p] += row[p];
      for (std::size_t p = 0; p < k_parts; ++p) entry[p] = sum[p];
    }
  }
}

void sum_regions(const ShapeInput& in, std::size_t begin, std::size_t end, const float* table,
                 float* sums) noexcept {
  for (std::size_t j = begin; j < end; ++j) sum_rows(table, in.regions, j, sums + j * k_row);
}

void goals(const ShapeInput& in, std::size_t begin, std::size_t end, const float* table,
           Vectors pull) noexcept {
  for (std::size_t i = begin; i < end; ++i) {
    alignas(64) float s[k_row];
    float u[3];
    sum_rows(table, in.memberships, i, s);
    displacement(in, i, u);
    const float x = in.reference.x[i], y = in.reference.y[i], z = in.reference.z[i], w = in.weight[i];
    pull.x[i] = w * (s[0] * x + s[1] * y + s[2] * z + s[9]) - u[0];
    pull.y[i] = w * (s[3] * x + s[4] * y + s[5] * z + s[10]) - u[1];
    pull.z[i] = w * (s[6] * x + s[7] * y + s[8] * z + s[11]) - u[2];
  }
}

using Lanes = float[k_lanes];
#define MALLOW_LANES for (std::size_t l = 0; l < k_lanes; ++l)

void rotation_matrices(const Lanes* q, Lanes* r) {
  MALLOW_LANES {
    const float x = q[0][l], y = q[1][l], z = q[2][l], w = q[3][l];
    r[0][l] = 1.0f - 2.0f * (y * y + z * z);
    r[1][l] = 2.0f * (x * y - w * z);
    r[2][l] = 2.0f * (x * z + w * y);
    r[3][l] = 2.0f * (x * y + w * z);
    r[4][l] = 1.0f - 2.0f * (x * x + z * z);
    r[5][l] = 2.0f * (y * z - w * x);
    r[6][l] = 2.0f * (x * z - w * y);
    r[7][l] = 2.0f * (y * z + w * x);
    r[8][l] = 1.0f - 2.0f * (x * x + y * y);
  }
}

/// Newton's method for the maximum of tr(Rᵀ A): with M = Rᵀ A and S its symmetric part, the step is the
/// rotation vector (tr(S) I − S)⁻¹ axial(M), which converges quadratically (the Hessian form of Kugelstadt et
/// al. 2018). A maximum over rotations is the polar factor with det +1; where the Hessian is not clearly
/// definite the lane is left undecided. good[l]: 1 where the Hessian is definite and the last step was small,
/// or more iterations were not wanted: what is left then is for the next step's to take up.
void newton(const Lanes* a, const Lanes& scale, int iterations, Lanes* q, Lanes& good) {
  // A step below this leaves an error of its square: 1e-7 rad, single precision's own.
  constexpr float k_small_step = 3e-4f;
  // Smallest over largest pivot of the Hessian that counts as definite.
  constexpr float k_definite = 1e-3f;
  const bool early = iterations < k_enough_iterations;
  const float accepted = early ? __builtin_inff() : k_small_step * k_small_step;
  Lanes r[9];
  for (int iteration = 0; iteration < iterations; ++iteration) {
    rotation_matrices(q, r);
    float largest = 0;
    Lanes step;
    MALLOW_LANES {
      float m[9];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          m[3 * i + j] = r[i][l] * a[j][l] + r[3 + i][l] * a[3 + j][l] + r[6 + i][l] * a[6 + j][l];
      const float bx = m[7] - m[5], by = m[2] - m[6], bz = m[3] - m[1];
      const float hxx = m[4] + m[8], hyy = m[0] + m[8], hzz = m[0] + m[4];
      const float hxy = -0.5f * (m[1] + m[3]), hxz = -0.5f * (m[2] + m[6]), hyz = -0.5f * (m[5] + m[7]);
      // Cofactors of the symmetric Hessian; its leading minors say whether it is definite.
      const float cxx = hyy * hzz - hyz * hyz, cxy = hxz * hyz - hxy * hzz, cxz = hxy * hyz - hxz * hyy;
      const float cyy = hxx * hzz - hxz * hxz, cyz = hxy * hxz - hxx * hyz, czz = hxx * hyy - hxy * hxy;
      const float det = hxx * cxx + hxy * cxy + hxz * cxz;
      const float trace = hxx + hyy + hzz;
      const bool definite = trace > k_definite * scale[l] && hxx > 0 && czz > 0 &&
                            det > k_definite * trace * (cxx + cyy + czz) && cxx > 0 && cyy > 0;
      const float inverse = definite ? 1.0f / det : 0.0f;
      const float wx = inverse * (cxx * bx + cxy * by + cxz * bz);
      const float wy = inverse * (cxy * bx + cyy * by + cyz * bz);
      const float wz = inverse * (cxz * bx + cyz * by + czz * bz);
      const float squared = wx * wx + wy * wy + wz * wz;
      step[l] = squared;
      good[l] = definite && squared < accepted ? 1.0f : 0.0f;
      // q ← q (1, ω/2), normalised. Where Newton may not get to converge, ω is better taken for the tangent
      // of the turn, which it is where A is round: with ω/2 a turn by θ would end at θ + θ³/4, and one
      // iteration a step spun a tumbling cube up by a quarter in 600 steps of 0.08 rad.
      const float half = early ? 1.0f / (1.0f + __builtin_sqrtf(1.0f + squared)) : 0.5f;
      const float hx = half * wx, hy = half * wy, hz = half * wz;
      const float x = q[0][l], y = q[1][l], z = q[2][l], w = q[3][l];
      const float nx = x + w * hx + y * hz - z * hy;
      const float ny = y + w * hy + z * hx - x * hz;
      const float nz = z + w * hz + x * hy - y * hx;
      const float nw = w - x * hx - y * hy - z * hz;
      const float norm = 1.0f / __builtin_sqrtf(nx * nx + ny * ny + nz * nz + nw * nw);
      q[0][l] = nx * norm;
      q[1][l] = ny * norm;
      q[2][l] = nz * norm;
      q[3][l] = nw * norm;
    }
    MALLOW_LANES largest = step[l] > largest ? step[l] : largest;
    if (largest < k_small_step * k_small_step) return;
  }
}

void solve_rotations(const ShapeInput& in, std::size_t begin, std::size_t end, int iterations, float* sums,
                     float* const* rotation, std::uint8_t* undecided) noexcept {
  for (std::size_t block = begin; block < end; block += k_lanes) {
    const std::size_t lanes = end - block < k_lanes ? end - block : k_lanes;
    Lanes s[12] = {}, q[4], a[9], r[9], scale, good;
    for (std::size_t l = 0; l < lanes; ++l)
      for (std::size_t k = 0; k < 12; ++k) s[k][l] = sums[(block + l) * k_row + k];
    for (std::size_t k = 0; k < 4; ++k) MALLOW_LANES q[k][l] = rotation[k][block + l];
    const float* const g = in.frame_rotation;
    MALLOW_LANES {
      const std::size_t j = block + l;
      const float cx = in.center.x[j], cy = in.center.y[j], cz = in.center.z[j];
      const float xx = in.moment[0][j], yy = in.moment[1][j], zz = in.moment[2][j];
      const float yz = in.moment[3][j], xz = in.moment[4][j], xy = in.moment[5][j];
      for (int i = 0; i < 3; ++i) {
        const float gx = g[3 * i], gy = g[3 * i + 1], gz = g[3 * i + 2];
        a[3 * i][l] = gx * xx + gy * xy + gz * xz + (s[3 * i][l] - s[9 + i][l] * cx);
        a[3 * i + 1][l] = gx * xy + gy * yy + gz * yz + (s[3 * i + 1][l] - s[9 + i][l] * cy);
        a[3 * i + 2][l] = gx * xz + gy * yz + gz * zz + (s[3 * i + 2][l] - s[9 + i][l] * cz);
      }
      scale[l] = xx + yy + zz;
      good[l] = 0;
    }
    newton(a, scale, iterations, q, good);
    rotation_matrices(q, r);
    for (std::size_t l = 0; l < lanes; ++l) {
      const std::size_t j = block + l;
      float* const row = sums + j * k_row;
      undecided[j] = good[l] == 0.0f;
      if (undecided[j]) {
        for (std::size_t k = 0; k < 9; ++k) row[k] = a[k][l];
        continue;
      }
      for (std::size_t k = 0; k < 4; ++k) rotation[k][j] = q[k][l];
      const float inverse = 1.0f / in.region_weight[j];
      for (std::size_t i = 0; i < 3; ++i) {
        const float x = r[3 * i][l] - g[3 * i], y = r[3 * i + 1][l] - g[3 * i + 1],
                    z = r[3 * i + 2][l] - g[3 * i + 2];
        row[3 * i] = x;
        row[3 * i + 1] = y;
        row[3 * i + 2] = z;
        row[9 + i] = row[9 + i] * inverse - (x * in.center.x[j] + y * in.center.y[j] + z * in.center.z[j]);
      }
    }
  }
}

#undef MALLOW_LANES

}  // namespace

extern const ShapeKernels shape_kernels;
const ShapeKernels shape_kernels = {write_rows, sum_runs, sum_regions, solve_rotations, goals};

}  // namespace mallow::MALLOW_LEVEL

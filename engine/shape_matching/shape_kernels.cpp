// Region sums and goal positions of model section 2: [TK eq. 7] with the weights of Rivers & James
// 2007, which keep momentum exactly. Departs from [TK]: region centres c̄_j stand where the print has x̄_j.
#include "shape_matching/shape_kernels.h"

#include "core/lanes.h"

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

/// Rows are added in the widest registers of the level by name: left to itself GCC 12 keeps half of the
/// accumulators below in single floats at AVX2 and AVX-512, four times as slow.
constexpr std::size_t k_parts = k_row / k_width;

void add_row(const float* row, Lanes* sum) {
  for (std::size_t p = 0; p < k_parts; ++p) sum[p] += load(row + p * k_width);
}
void add_row(const float* rows, std::uint32_t i, Lanes* sum) {
  add_row(rows + static_cast<std::size_t>(i) * k_row, sum);
}

/// Adds the rows of a list. Four accumulators in a fixed order hide the latency of the addition.
void sum_rows(const float* rows, const RegionLists& lists, std::size_t which, float* sum) {
  const std::uint32_t* const list = lists.entries + lists.begin[which];
  const std::uint32_t n = lists.count[which];
  Lanes a[k_parts] = {}, b[k_parts] = {}, c[k_parts] = {}, d[k_parts] = {};
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
  for (std::size_t p = 0; p < k_parts; ++p) store((a[p] + b[p]) + (c[p] + d[p]), sum + p * k_width);
}

void sum_runs(const float* rows, std::size_t count, const RunLengths& lengths, std::size_t all,
              float* table) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    Lanes sum[k_parts] = {};
    const float* row = rows + i * k_row;
    float* entry = table + i * k_row;
    std::uint32_t length = 0;
    for (std::uint32_t level = 0; level < lengths.levels; ++level, entry += all * k_row) {
      for (; length < lengths.length[level]; ++length, row += k_row) add_row(row, sum);
      for (std::size_t p = 0; p < k_parts; ++p) store(sum[p], entry + p * k_width);
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

}  // namespace

extern const ShapeKernels shape_kernels;
const ShapeKernels shape_kernels = {write_rows, sum_runs, sum_regions, goals};

}  // namespace mallow::MALLOW_LEVEL

// Region sums and goal positions of model section 2: [TK eq. 7] with the weights of Rivers & James
// 2007, which keep momentum exactly. Departs from [TK]: region centres c̄_j stand where the print has x̄_j.
#include "shape_matching/shape_lanes.h"

#include "core/lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// u_i: what is left of a position when the group's rigid motion is taken out.
inline LaneVec3 displacement(const ShapeInput& in, const LaneVec3& position, const LaneVec3& reference) {
  const float* const r = in.frame_rotation;
  const Lanes x = reference.x, y = reference.y, z = reference.z;
  const LaneVec3 turned = {r[0] * x + r[1] * y + r[2] * z, r[3] * x + r[4] * y + r[5] * z,
                           r[6] * x + r[7] * y + r[8] * z};
  return (position - all_lanes(in.frame_translation)) - turned;
}

void write_rows(const ShapeInput& in, std::size_t begin, std::size_t end, float* rows) noexcept {
  for_rows(begin, end, [&](const auto& part) {
    const LaneVec3 reference = get(part, in.reference);
    const LaneVec3 u = displacement(in, get(part, in.position), reference);
    const Lanes w = part.get(in.weight);
    const Lanes wu[3] = {w * u.x, w * u.y, w * u.z};
    Lanes numbers[k_row_sums];
    for (std::size_t a = 0; a < 3; ++a) {
      numbers[3 * a] = wu[a] * reference.x;
      numbers[3 * a + 1] = wu[a] * reference.y;
      numbers[3 * a + 2] = wu[a] * reference.z;
      numbers[9 + a] = wu[a];
    }
    float* const to = rows + (part.row - begin) * k_row;
    if (part.count == k_width) {
      store_transposed(numbers, k_row_sums, k_row, to);
    } else {
      alignas(64) float last[k_width * k_row] = {};
      store_transposed(numbers, k_row_sums, k_row, last);
      copy_bytes(to, last, part.count * k_row * sizeof(float));
    }
  });
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
        fetch_ahead(rows + static_cast<std::size_t>(list[ahead]) * k_row);
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
    for (std::uint32_t l = 0; l < lengths.count; ++l, entry += all * k_row) {
      for (; length < lengths.length[l]; ++length, row += k_row) add_row(row, sum);
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
  alignas(64) float rows[k_width * k_row] = {};
  for_rows(begin, end, [&](const auto& part) {
    for (std::size_t l = 0; l < part.count; ++l)
      sum_rows(table, in.memberships, part.row + l, rows + l * k_row);
    Lanes s[k_row];
    load_transposed(rows, k_row, in.elasticity ? k_row : k_row_sums, s);
    const LaneVec3 reference = get(part, in.reference);
    const LaneVec3 u = displacement(in, get(part, in.position), reference);
    const Lanes x = reference.x, y = reference.y, z = reference.z;
    const LaneVec3 sum = {s[0] * x + s[1] * y + s[2] * z + s[9], s[3] * x + s[4] * y + s[5] * z + s[10],
                          s[6] * x + s[7] * y + s[8] * z + s[11]};
    const Lanes w = part.get(in.weight);
    put(part, in.elasticity ? w * (sum - s[k_row_sums] * u) : w * sum - u, pull);
  });
}

}  // namespace

extern const ShapeLanes shape_lanes;
const ShapeLanes shape_lanes = {write_rows, sum_runs, sum_regions, goals};

}  // namespace mallow::MALLOW_LEVEL

// The rotations of model section 2: polar factors with det +1, warm-started. [TK eq. 7; Kugelstadt et al.
// 2018]
#include "shape_matching/rotation_lanes.h"

#include "shape_matching/newton_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

// k_width regions from j on; rows: their sums. Where Newton does not decide, the last rotation stays.
LaneBytes solve_lanes(const ShapeInput& in, std::size_t j, int iterations, float* rows,
                      float* const* rotation) {
  Lanes sums[12], a[k_row], moment[6], q[4], r[9];
  load_transposed(rows, k_row, 12, sums);
  const LaneVec3 center = get(WholeRows{j}, in.center);
  for (int k = 0; k < 6; ++k) moment[k] = load(in.moment[k] + j);
  for (int k = 0; k < 4; ++k) q[k] = load(rotation[k] + j);
  region_matrices(in.frame_rotation, sums, center, moment, a);
  Lanes turned[4] = {q[0], q[1], q[2], q[3]};
  const LaneMask good = newton(a, moment[0] + moment[1] + moment[2], iterations, turned);
  for (int k = 0; k < 4; ++k) store(good ? turned[k] : q[k], rotation[k] + j);
  rotation_matrices(turned, r);
  // Plus 0, or what is not a number where the weight is infinite and the quotient would hide it.
  const Lanes weight = load(in.region_weight + j), inverse = 1.0f / weight + (weight - weight);
  for (int i = 0; i < 3; ++i) {
    const float* const g = in.frame_rotation + 3 * i;
    const Lanes x = r[3 * i] - g[0], y = r[3 * i + 1] - g[1], z = r[3 * i + 2] - g[2];
    const Lanes shift = sums[9 + i] * inverse - (x * center.x + y * center.y + z * center.z);
    a[3 * i] = good ? x : a[3 * i];
    a[3 * i + 1] = good ? y : a[3 * i + 1];
    a[3 * i + 2] = good ? z : a[3 * i + 2];
    a[9 + i] = good ? shift : sums[9 + i];
  }
  weigh_and_store(in, j, good, a, rows);
  return bytes(~good);
}

void solve(const ShapeInput& in, std::size_t begin, std::size_t end, int iterations, float* sums,
           float* const* rotation, std::uint8_t* undecided) noexcept {
  std::size_t j = begin;
  for (; j + k_width <= end; j += k_width) {
    const LaneBytes left = solve_lanes(in, j, iterations, sums + j * k_row, rotation);
    copy_bytes(undecided + j, &left, k_width);
  }
  if (j == end) return;
  // The other columns are padded, rows and flags are not. A padded lane has no moment, so it is undecided and
  // keeps its zeros.
  const std::size_t rest = (end - j) * k_row * sizeof(float);
  alignas(64) float rows[k_width * k_row] = {};
  copy_bytes(rows, sums + j * k_row, rest);
  const LaneBytes left = solve_lanes(in, j, iterations, rows, rotation);
  copy_bytes(sums + j * k_row, rows, rest);
  copy_bytes(undecided + j, &left, end - j);
}

}  // namespace

extern const RotationLanes rotation_lanes;
const RotationLanes rotation_lanes = {solve};

}  // namespace mallow::MALLOW_LEVEL

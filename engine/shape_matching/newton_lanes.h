#pragma once

// Newton's method for rotations, and rows of regions, for the files of lanes that solve them:
// rotation_lanes.h says what it finds and has its symbols. In an anonymous namespace of the level, as
// core/lanes.h. [Kugelstadt et al. 2018]
#include "core/lanes.h"
#include "shape_matching/rotation_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

// R of unit quaternions x y z w, row by row.
inline void rotation_matrices(const Lanes* q, Lanes* r) {
  const Lanes x = q[0], y = q[1], z = q[2], w = q[3];
  r[0] = 1.0f - 2.0f * (y * y + z * z);
  r[1] = 2.0f * (x * y - w * z);
  r[2] = 2.0f * (x * z + w * y);
  r[3] = 2.0f * (x * y + w * z);
  r[4] = 1.0f - 2.0f * (x * x + z * z);
  r[5] = 2.0f * (y * z - w * x);
  r[6] = 2.0f * (x * z - w * y);
  r[7] = 2.0f * (y * z + w * x);
  r[8] = 1.0f - 2.0f * (x * x + y * y);
}

// A Newton step of all lanes.
struct Step {
  LaneVec3 tangent;   // ω − c: the axis times the tangent of the turn
  LaneMask definite;  // the Hessian is; elsewhere the tangent is 0
  LaneMask last;      // what is left after the step is below single precision
};

// Where A is round, ω is the tangent of the turn exactly. Taken for half the turn's quaternion instead, it
// left θ³/4, and one iteration a step spun a tumbling cube up by a quarter in 600 steps of 0.08 rad.
//
// c comes of expanding M = exp(θ) S in θ: ω = tan θ + c + O(θ⁵). What c leaves is below 1.4 κ |c| |ω|² for
// every A tried, κ = tr(H) tr(H⁻¹)/9 >= 1, so that most regions that turn by up to 0.15 rad a step take one
// iteration, where without c all took two.
inline Step newton_step(const Lanes* r, const Lanes* a, const Lanes& scale) {
  // Smallest over largest pivot of the Hessian that counts as definite.
  constexpr float k_definite = 1e-3f;
  // (7e-7 rad)²: single precision's own error is about as large.
  constexpr float k_squared_error = 5e-13f;
  Lanes m[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m[3 * i + j] = r[i] * a[j] + r[3 + i] * a[3 + j] + r[6 + i] * a[6 + j];
  const LaneVec3 b = {m[7] - m[5], m[2] - m[6], m[3] - m[1]};
  const Lanes hxx = m[4] + m[8], hyy = m[0] + m[8], hzz = m[0] + m[4];
  const Lanes hxy = -0.5f * (m[1] + m[3]), hxz = -0.5f * (m[2] + m[6]), hyz = -0.5f * (m[5] + m[7]);
  // Cofactors of the symmetric Hessian; its leading minors say whether it is definite.
  const Lanes cxx = hyy * hzz - hyz * hyz, cxy = hxz * hyz - hxy * hzz, cxz = hxy * hyz - hxz * hyy;
  const Lanes cyy = hxx * hzz - hxz * hxz, cyz = hxy * hxz - hxx * hyz, czz = hxx * hyy - hxy * hxy;
  const Lanes det = hxx * cxx + hxy * cxy + hxz * cxz;
  const Lanes trace = hxx + hyy + hzz;
  const Lanes minors = trace * (cxx + cyy + czz);
  const LaneMask definite = (trace > k_definite * scale) & (hxx > 0.0f) & (czz > 0.0f) &
                            (det > k_definite * minors) & (cxx > 0.0f) & (cyy > 0.0f);
  const Lanes inverse = definite ? 1.0f / det : Lanes{};
  const auto solve = [&](const LaneVec3& v) {
    return inverse * LaneVec3{cxx * v.x + cxy * v.y + cxz * v.z, cxy * v.x + cyy * v.y + cyz * v.z,
                              cxz * v.x + cyz * v.y + czz * v.z};
  };
  const LaneVec3 omega = solve(b);
  const LaneVec3 again = solve(omega);
  const Lanes squared = dot_from_left(omega, omega), gain = 0.25f * dot_from_left(omega, b);
  const LaneVec3 c = gain * again - (0.25f * squared) * omega;
  const Lanes correction = dot_from_left(c, c);
  // Far from the maximum the expansion says nothing.
  const Lanes near = correction < 0.0625f * squared ? all_lanes(1.0f) : Lanes{};
  const Lanes growth = minors * inverse * (1.0f / 9.0f) * squared;
  return {omega - near * c, definite, correction * growth * growth < k_squared_error};
}

// q ← q turned by an angle whose tangent is given, normalised: (1 + √(1 + t²), t) is the half angle's
// quaternion.
inline void turn(const LaneVec3& tangent, const LaneMask& active, Lanes* q) {
  const Lanes x = q[0], y = q[1], z = q[2], w = q[3];
  const Lanes tx = tangent.x, ty = tangent.y, tz = tangent.z;
  const Lanes secant = square_root(1.0f + dot_from_left(tangent, tangent)), tw = 1.0f + secant;
  const Lanes norm = 1.0f / square_root(2.0f * secant * tw * (x * x + y * y + z * z + w * w));
  const Lanes nx = tw * x + w * tx + y * tz - z * ty;
  const Lanes ny = tw * y + w * ty + z * tx - x * tz;
  const Lanes nz = tw * z + w * tz + x * ty - y * tx;
  const Lanes nw = tw * w - x * tx - y * ty - z * tz;
  q[0] = active ? nx * norm : x;
  q[1] = active ? ny * norm : y;
  q[2] = active ? nz * norm : z;
  q[3] = active ? nw * norm : w;
}

// Newton's method for the maximum of tr(Rᵀ A). A maximum over rotations is the polar factor with det +1;
// where the Hessian is not clearly definite a lane is left undecided. A lane stops at its own last step,
// whatever its neighbours do, so that its bits do not depend on them. Returns where the rotation is good: the
// Hessian is definite and the last step was small, or more iterations were not wanted: what is left then is
// for the next step's to take up.
inline LaneMask newton(const Lanes* a, const Lanes& scale, int iterations, Lanes* q) {
  const bool early = iterations > 0 && iterations < k_enough_iterations;
  LaneMask active = ~LaneMask{}, good = {};
  Lanes r[9];
  for (int iteration = 0; iteration < iterations; ++iteration) {
    rotation_matrices(q, r);
    const Step step = newton_step(r, a, scale);
    active &= step.definite;
    turn(step.tangent, active, q);
    good |= active & step.last;
    active &= ~step.last;
    if (!any(active)) return good;
  }
  return early ? good | active : good;
}

// A_j row by row, from the sums; moment: xx yy zz yz xz xy.
inline void region_matrices(const float* g, const Lanes* sums, const LaneVec3& center, const Lanes* moment,
                            Lanes* a) {
  const Lanes xx = moment[0], yy = moment[1], zz = moment[2], yz = moment[3], xz = moment[4], xy = moment[5];
  for (int i = 0; i < 3; ++i) {
    const float gx = g[3 * i], gy = g[3 * i + 1], gz = g[3 * i + 2];
    a[3 * i] = gx * xx + gy * xy + gz * xz + (sums[3 * i] - sums[9 + i] * center.x);
    a[3 * i + 1] = gx * xy + gy * yy + gz * yz + (sums[3 * i + 1] - sums[9 + i] * center.y);
    a[3 * i + 2] = gx * xz + gy * yz + gz * zz + (sums[3 * i + 2] - sums[9 + i] * center.z);
  }
}

// Rows a of k_width regions from j on, each e_j times where regions differ, with e_j itself as their
// thirteenth number; what is left undecided is not weighed yet. a: k_row lanes.
inline void weigh_and_store(const ShapeInput& in, std::size_t j, const LaneMask& good, Lanes* a,
                            float* rows) {
  if (!in.elasticity) return store_transposed(a, k_row_sums, k_row, rows);
  const Lanes e = load(in.elasticity + j);
  for (std::size_t k = 0; k < k_row_sums; ++k) a[k] = good ? e * a[k] : a[k];
  a[k_row_sums] = e;
  for (std::size_t k = k_row_sums + 1; k < k_row; ++k) a[k] = Lanes{};
  store_transposed(a, k_row, k_row, rows);
}

}  // namespace
}  // namespace mallow::MALLOW_LEVEL

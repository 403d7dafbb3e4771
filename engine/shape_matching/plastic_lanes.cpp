// Yield and creep of regions. [model 2, section 5; Mueller 2005, kept local] Departs from the model's print:
// what flows in a step is bounded, and thin is judged by the stretched reference shape, which bounds S too.
#include "shape_matching/plastic_lanes.h"

#include "shape_matching/newton_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// |y (Ê − I)| at most: a blow that flattens a region flows on in the next steps, and G has a determinant.
constexpr float k_most_flow = 0.5f;

/// Symmetric: xx yy zz yz xz xy, as moments are.
struct Symmetric {
  Lanes xx, yy, zz, yz, xz, xy;
};
Lanes trace(const Symmetric& s) {
  return s.xx + s.yy + s.zz;
}
Symmetric cofactors(const Symmetric& s) {
  return {s.yy * s.zz - s.yz * s.yz, s.xx * s.zz - s.xz * s.xz, s.xx * s.yy - s.xy * s.xy,
          s.xz * s.xy - s.xx * s.yz, s.xy * s.yz - s.xz * s.yy, s.xz * s.yz - s.xy * s.zz};
}
Lanes determinant(const Symmetric& s, const Symmetric& cofactor) {
  return s.xx * cofactor.xx + s.xy * cofactor.xy + s.xz * cofactor.xz;
}
Symmetric plus_identity(const Lanes& factor, const Symmetric& s) {
  return {1.0f + factor * s.xx, 1.0f + factor * s.yy, 1.0f + factor * s.zz,
          factor * s.yz,        factor * s.xz,        factor * s.xy};
}
Symmetric times_less_identity(const Lanes& factor, const Symmetric& s) {
  return {factor * s.xx - 1.0f, factor * s.yy - 1.0f, factor * s.zz - 1.0f,
          factor * s.yz,        factor * s.xz,        factor * s.xy};
}
Lanes norm(const Symmetric& s) {
  const Lanes off = s.yz * s.yz + s.xz * s.xz + s.xy * s.xy;
  return square_root(s.xx * s.xx + s.yy * s.yy + s.zz * s.zz + 2.0f * off);
}

/// x^(−⅓) of lanes above 0: a guess from the exponent, off by 4% at most, and three steps of Newton's method.
Lanes inverse_cube_root(const Lanes& x) {
  const Lanes third = __builtin_convertvector((LaneMask)x, Lanes) * (1.0f / 3.0f);
  Lanes y = (Lanes)(0x54a2fa8c - __builtin_convertvector(third, LaneMask));
  for (int k = 0; k < 3; ++k) y = y * (4.0f - x * y * y * y) * (1.0f / 3.0f);
  return y;
}

/// c = a b, all row by row.
void multiply(const Lanes* a, const Lanes* b, Lanes* c) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      c[3 * i + k] = a[3 * i] * b[k] + a[3 * i + 1] * b[3 + k] + a[3 * i + 2] * b[6 + k];
}
/// c = s b
void multiply(const Symmetric& s, const Lanes* b, Lanes* c) {
  const Lanes whole[9] = {s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz};
  multiply(whole, b, c);
}
/// c = a bᵀ
void multiply_transposed(const Lanes* a, const Lanes* b, Lanes* c) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      c[3 * i + k] = a[3 * i] * b[3 * k] + a[3 * i + 1] * b[3 * k + 1] + a[3 * i + 2] * b[3 * k + 2];
}

Lanes row_times(const Lanes* a, const Lanes* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// P = S B Sᵀ
Symmetric stretched_moment(const Lanes* s, const Symmetric& moment) {
  const Lanes b[9] = {moment.xx, moment.xy, moment.xz, moment.xy, moment.yy,
                      moment.yz, moment.xz, moment.yz, moment.zz};
  Lanes t[9];
  multiply(s, b, t);
  return {row_times(t, s),         row_times(t + 3, s + 3), row_times(t + 6, s + 6),
          row_times(t + 3, s + 6), row_times(t, s + 6),     row_times(t, s + 3)};
}

Symmetric load_moment(const ShapeInput& in, std::size_t j) {
  return {load(in.moment[0] + j), load(in.moment[1] + j), load(in.moment[2] + j),
          load(in.moment[3] + j), load(in.moment[4] + j), load(in.moment[5] + j)};
}

Lanes mean_extent(const Symmetric& moment) {
  return trace(moment) * (1.0f / 3.0f);
}
Lanes cube(const Lanes& value) {
  return value * value * value;
}

/// S and κ after this step. m: M, r: R, all row by row.
void flow_lanes(const ShapeInput& in, const FlowInput& rule, std::size_t j, const Lanes* m, const Lanes* r,
                const Lanes* s, float* const* stretch, float* flow) {
  const Symmetric b = load_moment(in, j), p = stretched_moment(s, b), adjoint = cofactors(p);
  const Lanes volume = determinant(p, adjoint);
  const LaneMask thick = (volume > k_thin * cube(mean_extent(p))) &
                         (determinant(b, cofactors(b)) > k_single_layer * cube(mean_extent(b)));
  const Lanes inverse = thick ? 1.0f / volume : Lanes{};
  Lanes n[9], f[9];  // Rᵀ M, and that times the cofactors of P
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) n[3 * i + k] = r[i] * m[k] + r[3 + i] * m[3 + k] + r[6 + i] * m[6 + k];
  const Lanes whole[9] = {adjoint.xx, adjoint.xy, adjoint.xz, adjoint.xy, adjoint.yy,
                          adjoint.yz, adjoint.xz, adjoint.yz, adjoint.zz};
  multiply(n, whole, f);
  const Lanes half = 0.5f * inverse;
  const Symmetric e = {inverse * f[0],       inverse * f[4],       inverse * f[8],
                       half * (f[5] + f[7]), half * (f[2] + f[6]), half * (f[1] + f[3])};
  const Symmetric minors = cofactors(e);
  const Lanes det = determinant(e, minors);
  const LaneMask upright = thick & (e.xx > 0.0f) & (minors.zz > 0.0f) & (det > 0.0f);
  const Symmetric strain = times_less_identity(inverse_cube_root(upright ? det : all_lanes(1.0f)), e);
  const Lanes size = norm(strain);
  const Lanes yield = rule.yields ? load(rule.yields + j) : all_lanes(rule.yield);
  // Not where it is infinite, whatever is wrong there.
  const LaneMask flows = upright & (size > yield) & (size < 1e30f);
  if (!any(flows)) return;
  const Lanes y = smaller((1.0f - yield / size) * rule.share, k_most_flow / size);
  const Symmetric g = plus_identity(y, strain);
  const Lanes scale = inverse_cube_root(flows ? determinant(g, cofactors(g)) : all_lanes(1.0f));
  const Symmetric change = times_less_identity(scale, g);
  Lanes added[9];
  multiply(change, s, added);
  for (int k = 0; k < 9; ++k) store(flows ? s[k] + added[k] : s[k], stretch[k] + j);
  const Lanes before = load(flow + j);
  store(flows ? before + norm(change) : before, flow + j);
}

/// What a region is read as, and S that it flows by.
struct Stretched {
  LaneVec3 center;
  Lanes rotation[4], stretch[9];
};
Stretched load_stretched(const ShapeInput& in, std::size_t j, const float* const* rotation,
                         const float* const* stretch) {
  Stretched region;
  region.center = get(WholeRows{j}, in.center);
  for (int k = 0; k < 4; ++k) region.rotation[k] = load(rotation[k] + j);
  for (int k = 0; k < 9; ++k) region.stretch[k] = load(stretch[k] + j);
  return region;
}

/// sums: M and the last three sums.
void finish_lanes(const ShapeInput& in, const FlowInput& rule, std::size_t j, const Stretched& region,
                  const Lanes* sums, float* rows, float* const* stretch, float* flow) {
  Lanes r[9], turned[k_row];
  const LaneVec3& center = region.center;
  rotation_matrices(region.rotation, r);
  multiply(r, region.stretch, turned);
  // Plus 0, or what is not a number where the weight is infinite and the quotient would hide it.
  const Lanes weight = load(in.region_weight + j), inverse = 1.0f / weight + (weight - weight);
  for (int i = 0; i < 3; ++i) {
    const float* const g = in.frame_rotation + 3 * i;
    Lanes* const row = turned + 3 * i;
    for (int k = 0; k < 3; ++k) row[k] = row[k] - g[k];
    turned[9 + i] = sums[9 + i] * inverse - (row[0] * center.x + row[1] * center.y + row[2] * center.z);
  }
  weigh_and_store(in, j, ~LaneMask{}, turned, rows);
  if (rule.share > 0) flow_lanes(in, rule, j, sums, r, region.stretch, stretch, flow);
}

/// As solve_lanes() of rotation_lanes.cpp. Where all are decided, they are finished as they lie in registers.
LaneBytes solve_lanes(const ShapeInput& in, const FlowInput* rule, std::size_t j, int iterations, float* rows,
                      float* const* rotation, float* const* stretch, float* flow) {
  Lanes sums[12], a[12], m[12], moment[6];
  load_transposed(rows, k_row, 12, sums);
  Stretched region = load_stretched(in, j, rotation, stretch);
  for (int k = 0; k < 6; ++k) moment[k] = load(in.moment[k] + j);
  region_matrices(in.frame_rotation, sums, region.center, moment, a);
  multiply_transposed(a, region.stretch, m);
  const Symmetric stretched = stretched_moment(region.stretch, load_moment(in, j));
  Lanes turned[4] = {region.rotation[0], region.rotation[1], region.rotation[2], region.rotation[3]};
  const LaneMask good = newton(m, trace(stretched), iterations, turned);
  for (int k = 0; k < 4; ++k) {
    region.rotation[k] = good ? turned[k] : region.rotation[k];
    store(region.rotation[k], rotation[k] + j);
  }
  for (int k = 9; k < 12; ++k) m[k] = sums[k];
  if (rule && !any(~good)) {
    finish_lanes(in, *rule, j, region, m, rows, stretch, flow);
    return LaneBytes{};
  }
  store_transposed(m, 12, k_row, rows);
  return bytes(~good) + k_unfinished;
}

/// Calls work(j, rows) for each k_width regions; those of the last, which may be fewer, lie in a copy, as
/// sums have no padding and columns have.
template <class Work>
void for_regions(std::size_t begin, std::size_t end, float* sums, const Work& work) {
  std::size_t j = begin;
  for (; j + k_width <= end; j += k_width) work(j, sums + j * k_row);
  if (j == end) return;
  const std::size_t rest = (end - j) * k_row * sizeof(float);
  alignas(64) float rows[k_width * k_row] = {};
  __builtin_memcpy(rows, sums + j * k_row, rest);
  work(j, rows);
  __builtin_memcpy(sums + j * k_row, rows, rest);
}

void solve(const ShapeInput& in, const FlowInput* rule, std::size_t begin, std::size_t end, int iterations,
           float* sums, float* const* rotation, float* const* stretch, float* flow,
           std::uint8_t* undecided) noexcept {
  for_regions(begin, end, sums, [&](std::size_t j, float* rows) {
    const LaneBytes left = solve_lanes(in, rule, j, iterations, rows, rotation, stretch, flow);
    __builtin_memcpy(undecided + j, &left, j + k_width <= end ? k_width : end - j);
  });
}

void finish(const ShapeInput& in, const FlowInput& rule, std::size_t begin, std::size_t end,
            const std::uint8_t* undecided, const float* const* rotation, float* sums, float* const* stretch,
            float* flow) noexcept {
  for_regions(begin, end, sums, [&](std::size_t j, float* rows) {
    if (undecided[j] == 0) return;  // nor is any beside it
    Lanes left[12];
    load_transposed(rows, k_row, 12, left);
    finish_lanes(in, rule, j, load_stretched(in, j, rotation, stretch), left, rows, stretch, flow);
  });
}

}  // namespace

extern const PlasticLanes plastic_lanes;
const PlasticLanes plastic_lanes = {solve, finish};

}  // namespace mallow::MALLOW_LEVEL

// Yield and creep of regions. [model 2, section 5; Mueller 2005, kept local] Departs from the model's print:
// what flows in a step is bounded, and thin is judged by the stretched reference shape, which bounds S too.
#include "shape_matching/plastic_lanes.h"

#include "shape_matching/newton_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// |y (Ê − I)| at most: a blow that flattens a region flows on in the next steps, and G has a determinant.
constexpr float k_most_flow = 0.5f;
/// Volume, in that at rest, between which a region flows whatever that does to its energy. Without, crushed
/// regions that flowed flat on a floor doubled the energy of a body in 30 steps; with the same bound on all,
/// or from 0.6 on, toothpaste and dents flowed less; from 0.34 on one body of 500 with random knobs gained.
constexpr float k_least_volume = 0.42f, k_most_volume = 2.0f;

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
Lanes squared_norm(const Symmetric& s) {
  const Lanes off = s.yz * s.yz + s.xz * s.xz + s.xy * s.xy;
  return s.xx * s.xx + s.yy * s.yy + s.zz * s.zz + 2.0f * off;
}
/// a − b, and tr(a a p).
Symmetric difference(const Symmetric& a, const Symmetric& b) {
  return {a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.yz - b.yz, a.xz - b.xz, a.xy - b.xy};
}
Lanes weighed_square(const Symmetric& a, const Symmetric& p) {
  const Lanes xx = a.xx * a.xx + a.xy * a.xy + a.xz * a.xz, yy = a.xy * a.xy + a.yy * a.yy + a.yz * a.yz;
  const Lanes zz = a.xz * a.xz + a.yz * a.yz + a.zz * a.zz, yz = a.xy * a.xz + a.yy * a.yz + a.yz * a.zz;
  const Lanes xz = a.xx * a.xz + a.xy * a.yz + a.xz * a.zz, xy = a.xx * a.xy + a.xy * a.yy + a.xz * a.yz;
  return xx * p.xx + yy * p.yy + zz * p.zz + 2.0f * (yz * p.yz + xz * p.xz + xy * p.xy);
}
Lanes norm(const Symmetric& s) {
  return square_root(squared_norm(s));
}

/// x^(−⅓) of lanes above 0: a guess from the exponent, off by 4% at most, and three steps of Newton's method.
Lanes inverse_cube_root(const Lanes& x) {
  const Lanes third = converted<Lanes>((LaneMask)x) * (1.0f / 3.0f);
  Lanes y = (Lanes)(0x54a2fa8c - converted<LaneMask>(third));
  for (int k = 0; k < 3; ++k) y = y * (4.0f - x * y * y * y) * (1.0f / 3.0f);
  return y;
}

// What follows is inlined: a call takes its nine numbers through memory.

/// c = a b, all row by row.
MALLOW_INLINE void multiply(const Lanes* a, const Lanes* b, Lanes* c) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      c[3 * i + k] = a[3 * i] * b[k] + a[3 * i + 1] * b[3 + k] + a[3 * i + 2] * b[6 + k];
}
/// c = a b
MALLOW_INLINE void multiply(const Lanes* a, const Symmetric& b, Lanes* c) {
  const Lanes whole[9] = {b.xx, b.xy, b.xz, b.xy, b.yy, b.yz, b.xz, b.yz, b.zz};
  multiply(a, whole, c);
}
/// c = s b
MALLOW_INLINE void multiply(const Symmetric& s, const Lanes* b, Lanes* c) {
  const Lanes whole[9] = {s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz};
  multiply(whole, b, c);
}
/// c = a bᵀ
MALLOW_INLINE void multiply_transposed(const Lanes* a, const Lanes* b, Lanes* c) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      c[3 * i + k] = a[3 * i] * b[3 * k] + a[3 * i + 1] * b[3 * k + 1] + a[3 * i + 2] * b[3 * k + 2];
}

MALLOW_INLINE Lanes row_times(const Lanes* a, const Lanes* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// S of k_width regions, row by row. Where all of them are I nothing is multiplied by it. A product with I
/// is the other factor but for the sign of its zeros, which is taken from both: how many regions are judged
/// together is the instruction level's, and a region's bits must not depend on that.
struct Stretch {
  Lanes s[9];
  bool any;  ///< one of them is not I
};
MALLOW_INLINE Stretch load_stretch(const float* const* columns, std::size_t j) {
  Stretch stretch;
  LaneMask other = {};
  for (int k = 0; k < 9; ++k) {
    stretch.s[k] = load(columns[k] + j);
    other |= stretch.s[k] != (k % 4 == 0 ? 1.0f : 0.0f);
  }
  stretch.any = any(other);
  return stretch;
}
/// to = a Sᵀ
MALLOW_INLINE void times_transposed(const Lanes* a, const Stretch& stretch, Lanes* to) {
  Lanes product[9];
  if (stretch.any) multiply_transposed(a, stretch.s, product);
  for (int k = 0; k < 9; ++k) to[k] = (stretch.any ? product[k] : a[k]) + 0.0f;
}
/// to = a S
MALLOW_INLINE void times(const Lanes* a, const Stretch& stretch, Lanes* to) {
  Lanes product[9];
  if (stretch.any) multiply(a, stretch.s, product);
  for (int k = 0; k < 9; ++k) to[k] = (stretch.any ? product[k] : a[k]) + 0.0f;
}
/// P = S B Sᵀ
MALLOW_INLINE Symmetric stretched_moment(const Stretch& stretch, const Symmetric& moment) {
  const Lanes* const s = stretch.s;
  Symmetric p = moment;
  if (stretch.any) {
    Lanes t[9];
    multiply(s, moment, t);
    p = {row_times(t, s),         row_times(t + 3, s + 3), row_times(t + 6, s + 6),
         row_times(t + 3, s + 6), row_times(t, s + 6),     row_times(t, s + 3)};
  }
  return {p.xx, p.yy, p.zz, p.yz + 0.0f, p.xz + 0.0f, p.xy + 0.0f};
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

/// k_width regions.
struct Region {
  LaneVec3 center;
  Lanes rotation[4];
  Stretch stretch;
  Symmetric moment, stretched;  ///< B, P
};
MALLOW_INLINE Region load_region(const ShapeInput& in, std::size_t j, const float* const* rotation,
                                 const float* const* stretch) {
  Region region;
  region.center = get(WholeRows{j}, in.center);
  for (int k = 0; k < 4; ++k) region.rotation[k] = load(rotation[k] + j);
  region.stretch = load_stretch(stretch, j);
  region.moment = load_moment(in, j);
  region.stretched = stretched_moment(region.stretch, region.moment);
  return region;
}

/// S and κ after this step. m: M, r: R, all row by row.
MALLOW_INLINE void flow_lanes(const FlowInput& rule, std::size_t j, const Lanes* m, const Lanes* r,
                              const Region& region, float* const* stretch, float* flow) {
  // A strain whose square is this much of the yield's may be beyond it: no root is taken of any below.
  constexpr float k_near = 0.999f;
  const Symmetric &b = region.moment, &p = region.stretched, adjoint = cofactors(p);
  const Lanes volume = determinant(p, adjoint);
  const LaneMask thick = volume > k_thin * cube(mean_extent(p));
  const Lanes inverse = thick ? 1.0f / volume : Lanes{};
  Lanes n[9], f[9];  // Rᵀ M, and that times the cofactors of P
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) n[3 * i + k] = r[i] * m[k] + r[3 + i] * m[3 + k] + r[6 + i] * m[6 + k];
  multiply(n, adjoint, f);
  const Lanes half = 0.5f * inverse;
  const Symmetric e = {inverse * f[0],       inverse * f[4],       inverse * f[8],
                       half * (f[5] + f[7]), half * (f[2] + f[6]), half * (f[1] + f[3])};
  const Symmetric minors = cofactors(e);
  const Lanes det = determinant(e, minors);
  const LaneMask upright = thick & (e.xx > 0.0f) & (minors.zz > 0.0f) & (det > 0.0f);
  const Symmetric strain = times_less_identity(inverse_cube_root(upright ? det : all_lanes(1.0f)), e);
  const Lanes squared = squared_norm(strain);
  const Lanes yield = rule.yields ? load(rule.yields + j) : all_lanes(rule.yield);
  const LaneMask near = upright & (squared > k_near * yield * yield);
  if (!any(near)) return;
  const LaneMask layers = determinant(b, cofactors(b)) > k_single_layer * cube(mean_extent(b));
  const Lanes size = square_root(squared);
  // Not where it is infinite, whatever is wrong there.
  const LaneMask flows = near & layers & (size > yield) & (size < 1e30f);
  if (!any(flows)) return;
  const Lanes y = smaller((1.0f - yield / size) * rule.share, k_most_flow / size);
  const Symmetric g = plus_identity(y, strain);
  const Lanes scale = inverse_cube_root(flows ? determinant(g, cofactors(g)) : all_lanes(1.0f));
  const Symmetric change = times_less_identity(scale, g), whole = times_less_identity(all_lanes(1.0f), e);
  // As G has a determinant of 1, flow along an axis where a region is thin is flow along the others the other
  // way, and in what is crushed or comes apart that may cost more than it takes.
  const LaneMask is_whole = (det > k_least_volume) & (det < k_most_volume);
  const LaneMask takes =
      flows & (is_whole | (weighed_square(difference(whole, change), p) <= weighed_square(whole, p)));
  const Lanes* const s = region.stretch.s;
  Lanes added[9];
  multiply(change, s, added);
  for (int k = 0; k < 9; ++k) store(takes ? s[k] + added[k] : s[k], stretch[k] + j);
  const Lanes before = load(flow + j);
  store(takes ? before + norm(change) : before, flow + j);
}

/// sums: M and the last three sums.
MALLOW_INLINE void finish_lanes(const ShapeInput& in, const FlowInput& rule, std::size_t j,
                                const Region& region, const Lanes* sums, float* rows, float* const* stretch,
                                float* flow) {
  Lanes r[9], turned[k_row];
  const LaneVec3& center = region.center;
  rotation_matrices(region.rotation, r);
  times(r, region.stretch, turned);
  // Plus 0, or what is not a number where the weight is infinite and the quotient would hide it.
  const Lanes weight = load(in.region_weight + j), inverse = 1.0f / weight + (weight - weight);
  for (int i = 0; i < 3; ++i) {
    const float* const g = in.frame_rotation + 3 * i;
    Lanes* const row = turned + 3 * i;
    for (int k = 0; k < 3; ++k) row[k] = row[k] - g[k];
    turned[9 + i] = sums[9 + i] * inverse - (row[0] * center.x + row[1] * center.y + row[2] * center.z);
  }
  weigh_and_store(in, j, ~LaneMask{}, turned, rows);
  if (rule.share > 0) flow_lanes(rule, j, sums, r, region, stretch, flow);
}

/// As solve_lanes() of rotation_lanes.cpp. Where all are decided, they are finished as they lie in registers.
LaneBytes solve_lanes(const ShapeInput& in, const FlowInput* rule, std::size_t j, int iterations, float* rows,
                      float* const* rotation, float* const* stretch, float* flow) {
  Lanes sums[12], a[9], m[12];
  load_transposed(rows, k_row, 12, sums);
  Region region = load_region(in, j, rotation, stretch);
  const Symmetric& b = region.moment;
  const Lanes moment[6] = {b.xx, b.yy, b.zz, b.yz, b.xz, b.xy};
  region_matrices(in.frame_rotation, sums, region.center, moment, a);
  times_transposed(a, region.stretch, m);
  Lanes turned[4] = {region.rotation[0], region.rotation[1], region.rotation[2], region.rotation[3]};
  const LaneMask good = newton(m, trace(region.stretched), iterations, turned);
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
  copy_bytes(rows, sums + j * k_row, rest);
  work(j, rows);
  copy_bytes(sums + j * k_row, rows, rest);
}

void solve(const ShapeInput& in, const FlowInput* rule, std::size_t begin, std::size_t end, int iterations,
           float* sums, float* const* rotation, float* const* stretch, float* flow,
           std::uint8_t* undecided) noexcept {
  for_regions(begin, end, sums, [&](std::size_t j, float* rows) {
    const LaneBytes left = solve_lanes(in, rule, j, iterations, rows, rotation, stretch, flow);
    copy_bytes(undecided + j, &left, j + k_width <= end ? k_width : end - j);
  });
}

void finish(const ShapeInput& in, const FlowInput& rule, std::size_t begin, std::size_t end,
            const std::uint8_t* undecided, const float* const* rotation, float* sums, float* const* stretch,
            float* flow) noexcept {
  for_regions(begin, end, sums, [&](std::size_t j, float* rows) {
    if (undecided[j] == 0) return;  // nor is any beside it
    Lanes left[12];
    load_transposed(rows, k_row, 12, left);
    finish_lanes(in, rule, j, load_region(in, j, rotation, stretch), left, rows, stretch, flow);
  });
}

}  // namespace

extern const PlasticLanes plastic_lanes;
const PlasticLanes plastic_lanes = {solve, finish};

}  // namespace mallow::MALLOW_LEVEL

// Sums over the particles near a block. Points go in groups of sixteen, two planes of 2 × 4 points: such a
// group sees a quarter of the particles near a block of voxels that are as wide as three of them are apart.
#include "surface/sum_lanes.h"

#include "core/wide_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// How far eight coordinates are from what lies between two others; 0 within.
MALLOW_INLINE Floats distance(const Floats& x, const Floats& low, const Floats& high) {
  return larger(larger(low - x, x - high), Floats{});
}

std::size_t pick_near(const BlockBox& block, ConstVectors positions, std::size_t count, Vectors near,
                      std::uint32_t* which) noexcept {
  const Floats limit = all(block.squared_reach);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < count; k += k_cluster) {
    const ClusterVec3 x = load(positions, k);
    const ClusterVec3 d = {distance(x.x, all(block.low[0]), all(block.high[0])),
                           distance(x.y, all(block.low[1]), all(block.high[1])),
                           distance(x.z, all(block.low[2]), all(block.high[2]))};
    const unsigned set = bits_of(is_at_most(dot_from_left(d, d), limit), count - k);
    if (set == 0) continue;
    compress(set, x.x, near.x + kept);
    compress(set, x.y, near.y + kept);
    compress(set, x.z, near.z + kept);
    kept += compress(set, k_count + static_cast<int>(k), which + kept);
  }
  float* const axes[3] = {near.x, near.y, near.z};
  for (int a = 0; a < 3; ++a) {
    const double corner = block.corner[a], per_radius = block.per_radius;
    float* const x = axes[a];
    for (std::size_t k = 0; k < kept; ++k)
      x[k] = static_cast<float>((static_cast<double>(x[k]) - corner) * per_radius);
    store(all(NearColumns::k_far), x + kept);
  }
  return kept;
}

/// 1 − |x_i − x|², at least 0, of points and one particle.
template <class L>
MALLOW_INLINE L nearness(const L& square) {
  return larger(1.0f - square, L{});
}

/// Groups of points above each other in z.
struct PointPillar {
  Floats low_x, high_x, low_y, high_y;
};

/// A value of points as those of their planes.
MALLOW_INLINE void put_lanes(const Floats& value, Floats* plane) {
  *plane = value;
}
#ifdef __AVX512F__
MALLOW_INLINE void put_lanes(const Wide& value, Floats* planes) {
  store(value, reinterpret_cast<float*>(planes));
}
#endif
template <class L>
MALLOW_INLINE void put_lanes(const Vec3Of<L>& v, Floats* planes, std::size_t stride) {
  put_lanes(v.x, planes);
  put_lanes(v.y, planes + stride);
  put_lanes(v.z, planes + 2 * stride);
}

// What is summed: a State of points, a lane each, over which particles, and what is put: k_values a plane,
// `stride` planes apart.

/// Kernels that are spheres of the kernel radius.
struct RoundKernel {
  /// What is known of eight particles from x and y.
  [[gnu::always_inline]] Floats across(const PointPillar& pillar, const ConstVectors& near,
                                       std::size_t k) const {
    const Floats dx = distance(load(near.x + k), pillar.low_x, pillar.high_x);
    const Floats dy = distance(load(near.y + k), pillar.low_y, pillar.high_y);
    return dx * dx + dy * dy;
  }
  [[gnu::always_inline]] bool any_in_reach(const Floats& square) const {
    return any(is_at_most(square, all(1.0f + k_reach_rounding)));
  }
  [[gnu::always_inline]] Ints in_reach(const Floats& square, const Floats& low, const Floats& high,
                                       const ConstVectors& near, std::size_t k) const {
    const Floats dz = distance(load(near.z + k), low, high);
    return is_at_most(square + dz * dz, all(1.0f + k_reach_rounding));
  }
};

struct BlendedSums : RoundKernel {
  static constexpr std::size_t k_values = k_sums;
  template <class L>
  struct State {
    L weight;
    Vec3Of<L> offset;
    L square;
  };
  template <class L>
  [[gnu::always_inline]] State<L> start() const {
    return State<L>{};
  }
  template <class L>
  [[gnu::always_inline]] void add(State<L>& s, const Vec3Of<L>& d, std::uint32_t) const {
    const L square = dot_from_left(d, d);
    const L t = nearness(square);
    const L w = t * t * t;
    s.weight += w;
    s.offset += w * d;
    s.square += w * square;
  }
  template <class L>
  [[gnu::always_inline]] void put(const State<L>& s, Floats* to, std::size_t stride) const {
    put_lanes(s.weight, to);
    put_lanes(s.offset, to + stride, stride);
    put_lanes(s.square, to + 4 * stride);
  }
};

struct NearestSquare : RoundKernel {
  float farthest;

  static constexpr std::size_t k_values = 1;
  template <class L>
  struct State {
    L least;
  };
  template <class L>
  [[gnu::always_inline]] State<L> start() const {
    return {L{} + farthest};
  }
  template <class L>
  [[gnu::always_inline]] void add(State<L>& s, const Vec3Of<L>& d, std::uint32_t) const {
    s.least = smaller(s.least, dot_from_left(d, d));
  }
  template <class L>
  [[gnu::always_inline]] void put(const State<L>& s, Floats* to, std::size_t) const {
    put_lanes(s.least, to);
  }
};

/// G v
template <class L>
MALLOW_INLINE Vec3Of<L> product(const Ellipsoid& g, const Vec3Of<L>& v) {
  return {g.xx * v.x + g.xy * v.y + g.xz * v.z, g.xy * v.x + g.yy * v.y + g.yz * v.z,
          g.xz * v.x + g.yz * v.y + g.zz * v.z};
}

// Yu & Turk 2013, eq. 6 and 7: φ(x) = Σ V_i W(|G_i (x_i − x)|), with the weights of above.
struct DensitySums {
  const Ellipsoid* shapes;
  ConstVectors reach;

  static constexpr std::size_t k_values = k_density_sums;
  template <class L>
  struct State {
    L density;
    Vec3Of<L> gradient;
  };
  template <class L>
  [[gnu::always_inline]] State<L> start() const {
    return State<L>{};
  }
  [[gnu::always_inline]] Ints across(const PointPillar& pillar, const ConstVectors& near,
                                     std::size_t k) const {
    const Floats dx = distance(load(near.x + k), pillar.low_x, pillar.high_x);
    const Floats dy = distance(load(near.y + k), pillar.low_y, pillar.high_y);
    return is_at_most(dx, load(reach.x + k)) & is_at_most(dy, load(reach.y + k));
  }
  [[gnu::always_inline]] bool any_in_reach(const Ints& reaches) const { return any(reaches); }
  [[gnu::always_inline]] Ints in_reach(const Ints& reaches, const Floats& low, const Floats& high,
                                       const ConstVectors& near, std::size_t k) const {
    return reaches & is_at_most(distance(load(near.z + k), low, high), load(reach.z + k));
  }
  template <class L>
  [[gnu::always_inline]] void add(State<L>& s, const Vec3Of<L>& d, std::uint32_t i) const {
    const Ellipsoid& g = shapes[i];
    const Vec3Of<L> q = product(g, d);
    const L t = nearness(dot_from_left(q, q));
    const L slope = g.weight * (t * t);
    s.density += slope * t;
    // ∇(1 − |G d|²)³ = 6 t² G (G d)
    s.gradient += slope * product(g, q);
  }
  template <class L>
  [[gnu::always_inline]] void put(const State<L>& s, Floats* to, std::size_t stride) const {
    put_lanes(s.density, to);
    put_lanes(6.0f * s.gradient, to + stride, stride);
  }
};

struct WeightedValues : RoundKernel {
  ConstVectors values;

  template <class L>
  struct State {
    L weight;
    Vec3Of<L> sum;
  };
  template <class L>
  [[gnu::always_inline]] State<L> start() const {
    return State<L>{};
  }
  template <class L>
  [[gnu::always_inline]] void add(State<L>& s, const Vec3Of<L>& d, std::uint32_t i) const {
    const L t = nearness(dot_from_left(d, d));
    const L w = t * t * t;
    s.weight += w;
    s.sum += Vec3Of<L>{w * values.x[i], w * values.y[i], w * values.z[i]};
  }
  template <class L>
  [[gnu::always_inline]] void put(const State<L>& s, Floats* to, std::size_t stride) const {
    put_lanes(s.weight, to);
    put_lanes(s.sum, to + stride, stride);
  }
};

/// Points of a group: `planes` times eight that differ in z from plane to plane.
template <std::size_t planes>
struct Group {
  Floats x, y, z[planes];
};

/// Lists, for each group of a pillar, the particles that reach into the box around it. low, high: of the
/// groups, in z. listed: a list a group, `room` long.
template <std::size_t groups, class Kernel>
MALLOW_INLINE void list_in_reach(const Kernel& kernel, const NearColumns& near, const PointPillar& pillar,
                                 const Floats* low, const Floats* high, std::size_t* counts) {
  const ConstVectors particles = near.positions;
  const std::size_t room = near.room(), end = near.count;
  std::uint32_t* to[groups];
  for (std::size_t g = 0; g < groups; ++g) to[g] = near.listed + g * room;
  Ints numbers = k_count;
  for (std::size_t k = 0; k < end; k += k_cluster, numbers += static_cast<int>(k_cluster)) {
    const auto across = kernel.across(pillar, particles, k);
    if (!kernel.any_in_reach(across)) continue;
    for (std::size_t g = 0; g < groups; ++g)
      to[g] += compress(bits(kernel.in_reach(across, low[g], high[g], particles, k)), numbers, to[g]);
  }
  for (std::size_t g = 0; g < groups; ++g)
    counts[g] = static_cast<std::size_t>(to[g] - (near.listed + g * room));
}

/// Sums at the points of a group over listed particles. Not inlined: a compiler that sees how a group's
/// points lie takes z for one number, and its arithmetic twice.
template <std::size_t planes, class Kernel>
[[gnu::noinline]] void sum_listed(const Kernel& kernel, const ConstVectors& near, const std::uint32_t* listed,
                                  std::size_t count, const Group<planes>& group, Floats* to,
                                  std::size_t stride) {
  const ConstVectors particles = near;
#ifdef __AVX512F__
  if constexpr (planes == 2) {
    const Vec3Of<Wide> x = {both(group.x, group.x), both(group.y, group.y), both(group.z[0], group.z[1])};
    auto sum = kernel.template start<Wide>();
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = listed[k];
      kernel.add(sum, Vec3Of<Wide>{particles.x[i] - x.x, particles.y[i] - x.y, particles.z[i] - x.z}, i);
    }
    kernel.put(sum, to, stride);
    return;
  }
#endif
  typename Kernel::template State<Floats> sums[planes];
#pragma GCC unroll 2
  for (auto& sum : sums) sum = kernel.template start<Floats>();
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = listed[k];
    const Floats dx = particles.x[i] - group.x, dy = particles.y[i] - group.y;
    for (std::size_t p = 0; p < planes; ++p)
      kernel.add(sums[p], ClusterVec3{dx, dy, particles.z[i] - group.z[p]}, i);
  }
#pragma GCC unroll 2
  for (std::size_t p = 0; p < planes; ++p) kernel.put(sums[p], to + p, stride);
}

/// Puts the sums at 2 × 4 × 4 points, a plane of which is a row of lanes, to where z goes fastest.
/// to: the first point's.
MALLOW_INLINE void put_planes(Floats* planes, std::size_t side, float* to) {
  transpose_halves(planes);
  for (std::size_t row = 0; row < 4; ++row) {
    const Quad low = shuffled<0, 1, 2, 3>(planes[row]);
    const Quad high = shuffled<4, 5, 6, 7>(planes[row]);
    copy_bytes(to + row * side, &low, sizeof low);
    copy_bytes(to + (side + row) * side, &high, sizeof high);
  }
}

/// Sums on a lattice of `side` points an axis, pillar by pillar of 2 × 4 × side.
template <std::size_t side, class Kernel>
MALLOW_INLINE void sum_in_pillars(const Kernel& kernel, const PointLattice& lattice, const NearColumns& near,
                                  float* to) {
  constexpr std::size_t k_groups = side / 2, n = side * side * side;
  float at[side];
  for (std::size_t k = 0; k < side; ++k)
    at[k] = static_cast<float>(static_cast<int>(k) * lattice.step) * lattice.voxel;
  Floats low[k_groups], high[k_groups];
  for (std::size_t g = 0; g < k_groups; ++g) {
    low[g] = all(at[2 * g]);
    high[g] = all(at[2 * g + 1]);
  }
  for (std::size_t i = 0; i < side; i += 2) {
    for (std::size_t j = 0; j < side; j += 4) {
      std::size_t counts[k_groups];
      list_in_reach<k_groups>(kernel, near, {all(at[i]), all(at[i + 1]), all(at[j]), all(at[j + 3])}, low,
                              high, counts);
      Group<2> group;
      for (std::size_t l = 0; l < k_cluster; ++l) {
        group.x[l] = at[i + l / 4];
        group.y[l] = at[j + l % 4];
      }
      Floats sums[Kernel::k_values][4];
      for (std::size_t g = 0; g < k_groups; ++g) {
        group.z[0] = low[g];
        group.z[1] = high[g];
        sum_listed<2>(kernel, near.positions, near.listed + g * near.room(), counts[g], group,
                      &sums[0][2 * (g % 2)], 4);
        if (g % 2 == 0) continue;
        for (std::size_t v = 0; v < Kernel::k_values; ++v)
          put_planes(sums[v], side, to + v * n + (i * side + j) * side + 2 * (g - 1));
      }
    }
  }
}

/// Sums at eight points in a box.
template <class Kernel>
MALLOW_INLINE void sum_at_eight(const Kernel& kernel, const NearColumns& near, const PointPillar& pillar,
                                const Floats& low_z, const Floats& high_z, const ClusterVec3& x,
                                Floats* sums) {
  std::size_t count;
  list_in_reach<1>(kernel, near, pillar, &low_z, &high_z, &count);
  sum_listed<1>(kernel, near.positions, near.listed, count, {x.x, x.y, {x.z}}, sums, 1);
}

/// Sums on a lattice of two points an axis.
template <class Kernel>
MALLOW_INLINE void sum_at_corners(const Kernel& kernel, const PointLattice& lattice, const NearColumns& near,
                                  float* to) {
  const float far = static_cast<float>(lattice.step) * lattice.voxel;
  const ClusterVec3 x = {
      {0, 0, 0, 0, far, far, far, far}, {0, 0, far, far, 0, 0, far, far}, {0, far, 0, far, 0, far, 0, far}};
  const Floats zero = all(0);
  Floats sums[Kernel::k_values];
  sum_at_eight(kernel, near, {zero, all(far), zero, all(far)}, zero, all(far), x, sums);
  for (std::size_t v = 0; v < Kernel::k_values; ++v) store(sums[v], to + v * k_cluster);
}

template <class Kernel>
void sum_on_lattice(const Kernel& kernel, const PointLattice& lattice, const NearColumns& near, float* to) {
  switch (lattice.step) {
    case 1:
      return sum_in_pillars<8>(kernel, lattice, near, to);
    case 2:
      return sum_in_pillars<4>(kernel, lattice, near, to);
    default:
      return sum_at_corners(kernel, lattice, near, to);
  }
}

void sum(const PointLattice& lattice, const NearColumns& near, float* sums) noexcept {
  sum_on_lattice(BlendedSums{}, lattice, near, sums);
}

void nearest(const PointLattice& lattice, const NearColumns& near, float farthest, float* squares) noexcept {
  sum_on_lattice(NearestSquare{{}, farthest}, lattice, near, squares);
}

void density(const PointLattice& lattice, const NearColumns& near, const Ellipsoid* shapes,
             ConstVectors reach, float* sums) noexcept {
  sum_on_lattice(DensitySums{shapes, reach}, lattice, near, sums);
}

void mean(ConstVectors points, std::size_t n, const NearColumns& near, ConstVectors values,
          Vectors means) noexcept {
  const auto largest = [](const Floats& x) { return -smallest(-x); };
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const ClusterVec3 x = load(points, k);
    Floats sums[4];  // of weights and of three values
    sum_at_eight(WeightedValues{{}, values}, near, {smallest(x.x), largest(x.x), smallest(x.y), largest(x.y)},
                 smallest(x.z), largest(x.z), x, sums);
    const Floats per_weight = where(is_larger(sums[0], Floats{}), 1.0f / sums[0]);
    const ClusterVec3 of_points = per_weight * ClusterVec3{sums[1], sums[2], sums[3]};
    store(of_points.x, means.x + k);
    store(of_points.y, means.y + k);
    store(of_points.z, means.z + k);
  }
}

}  // namespace

extern const SumLanes sum_lanes;
const SumLanes sum_lanes = {pick_near, sum, nearest, density, mean};

}  // namespace mallow::MALLOW_LEVEL

// Sums over the particles near a block. Points go in groups of sixteen, two planes of 2 × 4 points: such a
// group sees a quarter of the particles near a block of voxels that are as wide as three of them are apart.
#include "surface/sum_lanes.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

/// Share of the squared radius by which particles may look farther away from a box than from its points.
constexpr float k_rounding = 1e-5f;

/// A box of points.
struct Box {
  Floats low[3], high[3];
};

/// How far a point is from a box along an axis; negative within it.
MALLOW_INLINE Floats outside(const Box& box, int axis, const Floats& x) {
  return larger(box.low[axis] - x, x - box.high[axis]);
}

/// Which of eight particles are within the kernel radius of a box.
MALLOW_INLINE Ints within_radius(const Box& box, const ClusterVec3& x) {
  const ClusterVec3 d = {larger(outside(box, 0, x.x), Floats{}), larger(outside(box, 1, x.y), Floats{}),
                         larger(outside(box, 2, x.z), Floats{})};
  return is_at_most(dot_from_left(d, d), all(1.0f + k_rounding));
}

std::size_t pick_near(const BlockBox& block, ConstVectors positions, std::size_t count, Vectors near,
                      std::uint32_t* which) noexcept {
  const float* const from[3] = {positions.x, positions.y, positions.z};
  float* const to[3] = {near.x, near.y, near.z};
  for (int a = 0; a < 3; ++a) {
    const double corner = block.corner[a], per_radius = block.per_radius;
    for (std::size_t k = 0; k < count; ++k)
      to[a][k] = static_cast<float>((static_cast<double>(from[a][k]) - corner) * per_radius);
  }
  Box box = {};
  for (Floats& high : box.high) high = all(block.side);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < count; k += k_cluster) {
    const ClusterVec3 x = load(ConstVectors{near.x, near.y, near.z}, k);
    const unsigned set = bits_of(within_radius(box, x), count - k);
    compress(set, x.x, near.x + kept);
    compress(set, x.y, near.y + kept);
    compress(set, x.z, near.z + kept);
    kept += compress(set, k_count + static_cast<int>(k), which + kept);
  }
  return kept;
}

/// 1 − |x_i − x|², at least 0, of eight points and one particle.
MALLOW_INLINE Floats nearness(const Floats& square) {
  return larger(1.0f - square, Floats{});
}

// What is summed: a State of eight points, and of which particles.

/// Kernels that are spheres of the kernel radius.
struct RoundKernel {
  [[gnu::always_inline]] Ints in_reach(const Box& box, const ConstVectors& particles, std::size_t k) const {
    return within_radius(box, load(particles, k));
  }
};

struct BlendedSums : RoundKernel {
  static constexpr std::size_t k_values = k_sums;
  struct State {
    Floats weight;
    ClusterVec3 offset;
    Floats square;
  };
  [[gnu::always_inline]] State start() const { return State{}; }
  [[gnu::always_inline]] void add(State& s, const ClusterVec3& d, std::uint32_t) const {
    const Floats square = dot_from_left(d, d);
    const Floats t = nearness(square);
    const Floats w = t * t * t;
    s.weight += w;
    s.offset += w * d;
    s.square += w * square;
  }
  [[gnu::always_inline]] void put(const State& s, Floats* to, std::size_t stride) const {
    to[0] = s.weight;
    to[stride] = s.offset.x;
    to[2 * stride] = s.offset.y;
    to[3 * stride] = s.offset.z;
    to[4 * stride] = s.square;
  }
};

struct NearestSquare : RoundKernel {
  float farthest;

  static constexpr std::size_t k_values = 1;
  struct State {
    Floats least;
  };
  [[gnu::always_inline]] State start() const { return {all(farthest)}; }
  [[gnu::always_inline]] void add(State& s, const ClusterVec3& d, std::uint32_t) const {
    s.least = smaller(s.least, dot_from_left(d, d));
  }
  [[gnu::always_inline]] void put(const State& s, Floats* to, std::size_t) const { to[0] = s.least; }
};

/// G v
MALLOW_INLINE ClusterVec3 product(const Ellipsoid& g, const ClusterVec3& v) {
  return {g.xx * v.x + g.xy * v.y + g.xz * v.z, g.xy * v.x + g.yy * v.y + g.yz * v.z,
          g.xz * v.x + g.yz * v.y + g.zz * v.z};
}

// Yu & Turk 2013, eq. 6 and 7: φ(x) = Σ V_i W(|G_i (x_i − x)|), with the weights of above.
struct DensitySums {
  const Ellipsoid* shapes;
  ConstVectors reach;

  static constexpr std::size_t k_values = k_density_sums;
  struct State {
    Floats density;
    ClusterVec3 gradient;
  };
  [[gnu::always_inline]] State start() const { return State{}; }
  [[gnu::always_inline]] Ints in_reach(const Box& box, const ConstVectors& particles, std::size_t k) const {
    const ClusterVec3 x = load(particles, k), r = load(reach, k);
    return is_at_most(outside(box, 0, x.x), r.x) & is_at_most(outside(box, 1, x.y), r.y) &
           is_at_most(outside(box, 2, x.z), r.z);
  }
  [[gnu::always_inline]] void add(State& s, const ClusterVec3& d, std::uint32_t i) const {
    const Ellipsoid& g = shapes[i];
    const ClusterVec3 q = product(g, d);
    const Floats t = nearness(dot_from_left(q, q));
    const Floats slope = g.weight * (t * t);
    s.density += slope * t;
    // ∇(1 − |G d|²)³ = 6 t² G (G d)
    s.gradient += slope * product(g, q);
  }
  [[gnu::always_inline]] void put(const State& s, Floats* to, std::size_t stride) const {
    const ClusterVec3 gradient = 6.0f * s.gradient;
    to[0] = s.density;
    to[stride] = gradient.x;
    to[2 * stride] = gradient.y;
    to[3 * stride] = gradient.z;
  }
};

struct WeightedValues : RoundKernel {
  ConstVectors values;

  struct State {
    Floats weight;
    ClusterVec3 sum;
  };
  [[gnu::always_inline]] State start() const { return State{}; }
  [[gnu::always_inline]] void add(State& s, const ClusterVec3& d, std::uint32_t i) const {
    const Floats t = nearness(dot_from_left(d, d));
    const Floats w = t * t * t;
    s.weight += w;
    s.sum += ClusterVec3{w * values.x[i], w * values.y[i], w * values.z[i]};
  }
};

/// Sums at `planes` times eight points that differ in z from plane to plane, over the particles that reach
/// into the box around them.
template <std::size_t planes, class Kernel>
MALLOW_INLINE void sum_group(const Kernel& kernel, const NearColumns& near, const Box& box, const Floats& x,
                             const Floats& y, const Floats* z, typename Kernel::State* s) {
  const ConstVectors particles = near.positions;
  std::uint32_t* const listed = near.listed;
  std::size_t count = 0;
  for (std::size_t k = 0; k < near.count; k += k_cluster) {
    const unsigned set = bits_of(kernel.in_reach(box, particles, k), near.count - k);
    count += compress(set, k_count + static_cast<int>(k), listed + count);
  }
  typename Kernel::State sums[planes];
  for (typename Kernel::State& sum : sums) sum = kernel.start();
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = listed[k];
    const Floats dx = particles.x[i] - x, dy = particles.y[i] - y;
    for (std::size_t p = 0; p < planes; ++p) kernel.add(sums[p], {dx, dy, particles.z[i] - z[p]}, i);
  }
  for (std::size_t p = 0; p < planes; ++p) s[p] = sums[p];
}

/// Sums at 2 × 4 × 4 points whose first is (i, j, k) of a lattice of `side` points an axis.
template <class Kernel>
MALLOW_INLINE void sum_at_planes(const Kernel& kernel, const PointLattice& lattice, const NearColumns& near,
                                 int i, int j, int k, float* to) {
  const auto at = [&](int point) { return static_cast<float>(point * lattice.step) * lattice.voxel; };
  const Floats x = {at(i), at(i), at(i), at(i), at(i + 1), at(i + 1), at(i + 1), at(i + 1)};
  const Floats y = {at(j), at(j + 1), at(j + 2), at(j + 3), at(j), at(j + 1), at(j + 2), at(j + 3)};
  Floats sums[Kernel::k_values][4];
  for (int p = 0; p < 4; p += 2) {
    const Floats z[2] = {all(at(k + p)), all(at(k + p + 1))};
    const Box box = {{all(at(i)), all(at(j)), z[0]}, {all(at(i + 1)), all(at(j + 3)), z[1]}};
    typename Kernel::State s[2];
    sum_group<2>(kernel, near, box, x, y, z, s);
    for (int q = 0; q < 2; ++q) kernel.put(s[q], &sums[0][p + q], 4);
  }
  // A plane's lanes are points in x and y, and z is what goes fastest in memory.
  const auto side = static_cast<std::size_t>(lattice.side()), n = lattice.count();
  float* const first = to + (static_cast<std::size_t>(i) * side + static_cast<std::size_t>(j)) * side +
                       static_cast<std::size_t>(k);
  for (std::size_t v = 0; v < Kernel::k_values; ++v) {
    transpose_halves(sums[v]);
    for (std::size_t row = 0; row < 4; ++row) {
      const Floats& both = sums[v][row];
      const Quad low = __builtin_shufflevector(both, both, 0, 1, 2, 3);
      const Quad high = __builtin_shufflevector(both, both, 4, 5, 6, 7);
      __builtin_memcpy(first + v * n + row * side, &low, sizeof low);
      __builtin_memcpy(first + v * n + (side + row) * side, &high, sizeof high);
    }
  }
}

/// Sums at the eight points of a lattice that has two an axis.
template <class Kernel>
MALLOW_INLINE void sum_at_corners(const Kernel& kernel, const PointLattice& lattice, const NearColumns& near,
                                  float* to) {
  const float far = static_cast<float>(lattice.step) * lattice.voxel;
  const Floats x = {0, 0, 0, 0, far, far, far, far}, y = {0, 0, far, far, 0, 0, far, far};
  const Floats z = {0, far, 0, far, 0, far, 0, far};
  const Box box = {{}, {all(far), all(far), all(far)}};
  typename Kernel::State s;
  sum_group<1>(kernel, near, box, x, y, &z, &s);
  Floats sums[Kernel::k_values];
  kernel.put(s, sums, 1);
  for (std::size_t v = 0; v < Kernel::k_values; ++v) store(sums[v], to + v * k_cluster);
}

template <class Kernel>
void sum_on_lattice(const Kernel& kernel, const PointLattice& lattice, const NearColumns& near, float* to) {
  if (lattice.step == 4) return sum_at_corners(kernel, lattice, near, to);
  for (int i = 0; i < lattice.side(); i += 2)
    for (int j = 0; j < lattice.side(); j += 4)
      for (int k = 0; k < lattice.side(); k += 4) sum_at_planes(kernel, lattice, near, i, j, k, to);
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

/// The box of eight points.
Box box_of(const ClusterVec3& x) {
  Box box = {{x.x, x.y, x.z}, {x.x, x.y, x.z}};
  for (int a = 0; a < 3; ++a) {
    box.low[a] = smallest(box.low[a]);
    box.high[a] = -smallest(-box.high[a]);
  }
  return box;
}

void mean(ConstVectors points, std::size_t n, const NearColumns& near, ConstVectors values,
          Vectors means) noexcept {
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const ClusterVec3 x = load(points, k);
    WeightedValues::State s;
    sum_group<1>(WeightedValues{{}, values}, near, box_of(x), x.x, x.y, &x.z, &s);
    const Floats per_weight = where(is_larger(s.weight, Floats{}), 1.0f / s.weight);
    const ClusterVec3 of_points = per_weight * s.sum;
    store(of_points.x, means.x + k);
    store(of_points.y, means.y + k);
    store(of_points.z, means.z + k);
  }
}

}  // namespace

extern const SumLanes sum_lanes;
const SumLanes sum_lanes = {pick_near, sum, nearest, density, mean};

}  // namespace mallow::MALLOW_LEVEL

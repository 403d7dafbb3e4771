// The surface around particles of Zhu & Bridson 2005, "Animating sand as a fluid", section 5:
//   φ(x) = |x − x̄| − r,   x̄ = Σ w_i x_i / Σ w_i,   w_i = max(0, 1 − |x − x_i|²/R²)³
// symbol | here           | unit
// x_i    | particles      | offsets from the block's first voxel, divided by R
// R      | 1              | kernel radius
// r      | offset + ...   | grows with the weight, see SurfaceShape::extra_offset
// Departs: |x − x̄|² grows by half of what the variance Σ w_i |x_i − x̄|² / Σ w_i is above that of one part of
// a body. Between two parts x̄ jumps from one to the other and passes x on its way, which would make φ
// negative in the empty middle. Solenthaler et al. 2007 see that in the eigenvalues of ∇x̄, ten sums more; the
// variance is one sum more. The distance to the nearest particle tells it less well: it ripples, and leaves
// crumbs in gaps of two spacings.
#include "surface/surface_lanes.h"

#include "core/wide_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

static_assert(k_cluster == k_block_side, "a row of voxels is a row of lanes");

/// Densities, and slopes of them [per kernel radius], below this are none.
constexpr float k_least_density = 1e-6f, k_least_slope = 1e-6f;

/// Of points, a lane each.
template <class L>
struct Sums {
  L weight;
  Vec3Of<L> offset;
  L square;
};

template <class L>
MALLOW_INLINE L in_all(float value) {
  return L{} + value;
}

template <class L>
MALLOW_INLINE L cut(const SurfaceShape& shape, const L& distance) {
  return smaller(larger(distance, in_all<L>(-shape.background)), in_all<L>(shape.background));
}

template <class L>
MALLOW_INLINE L distance_of(const SurfaceShape& shape, const Sums<L>& s) {
  const L full = smaller(2.0f / shape.full_weight * s.weight, in_all<L>(1.0f));
  const L per_weight = 1.0f / larger(s.weight, in_all<L>(shape.least_weight));
  const Vec3Of<L> mean = per_weight * s.offset;
  const L from_mean = dot_from_left(mean, mean);
  const L excess = s.square * per_weight - from_mean - (shape.spread + shape.extra_spread * full);
  const L r = shape.offset + shape.extra_offset * full;
  const L distance = square_root(from_mean + k_excess_share * larger(excess, L{})) - r;
  const auto body = is_larger(s.weight, in_all<L>(shape.least_weight));
  const L outside = where(~body, in_all<L>(shape.background));
  return where(body, cut(shape, distance * (1.0f / shape.voxel_size))) + outside;
}

void distances(const SurfaceShape& shape, const float* sums, std::size_t n, float* to) noexcept {
  for (std::size_t k = 0; k < n; k += k_cluster)
    store(distance_of<Floats>(shape, {load(sums + k), load(sums + n + k, n), load(sums + 4 * n + k)}),
          to + k);
}

void find_sides(const float* distances, std::size_t n, float far, float deep, std::uint64_t* outside,
                std::uint64_t* inside) noexcept {
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const Floats distance = load(distances + k);
    const std::uint64_t out = bits(is_at_most(all(far), distance)),
                        in = bits(is_at_most(distance, all(deep)));
    const std::size_t word = k / 64, shift = k % 64;
    outside[word] = shift == 0 ? out : outside[word] | out << shift;
    inside[word] = shift == 0 ? in : inside[word] | in << shift;
  }
}

/// Interpolates to voxel v between nodes that are `stride` rows of lanes apart. What a weight of 0 would add
/// is left out.
template <int step, class L>
MALLOW_INLINE L blend(const NodeWeights& weights, std::size_t v, const L* nodes, std::size_t stride) {
  constexpr std::size_t k_step = step, k_before = step == 4 ? 1 : 0;
  const std::size_t below = v / k_step + k_before;
  if (v % k_step == 0) return nodes[below * stride];
  const std::size_t first = below < 2 ? 0 : 1;
  L sum = weights.w[v][first] * nodes[first * stride];
  for (std::size_t n = first + 1; n < first + 4; ++n) sum += weights.w[v][n] * nodes[n * stride];
  return sum;
}

template <int step>
void fill_between(const SurfaceShape& of, const NodeWeights& weights, const NodeRows& nodes,
                  float* to) noexcept {
  // A copy that what is written cannot alias: else its quotients are taken anew for each row.
  const SurfaceShape shape = of;
  constexpr std::size_t k_side = k_block_side;
  // Weights along z, a lane a voxel.
  Floats along_z[k_nodes];
  for (std::size_t n = 0; n < k_nodes; ++n)
    for (std::size_t v = 0; v < k_side; ++v) along_z[n][v] = weights.w[v][n];
  // By sum, node x and voxel y, one or two rows along z.
  Wide by_plane[k_sums][k_nodes][k_side / k_wide];
  for (std::size_t s = 0; s < k_sums; ++s) {
    for (std::size_t x = 0; x < k_nodes; ++x) {
      Floats rows[k_nodes];
      for (std::size_t y = 0; y < k_nodes; ++y) {
        const float* const from = nodes.four[x * k_nodes + y] + s * nodes.stride;
        rows[y] = from[0] * along_z[0];
        for (std::size_t n = 1; n < k_nodes - 1; ++n) rows[y] += from[n] * along_z[n];
        rows[y] += nodes.fifth[x * k_nodes + y][s * nodes.stride] * along_z[k_nodes - 1];
      }
#pragma GCC unroll 8
      for (std::size_t y = 0; y < k_side; ++y) {
        const Floats row = blend<step>(weights, y, rows, 1);
        copy_bytes(reinterpret_cast<Floats*>(by_plane[s][x]) + y, &row, sizeof row);
      }
    }
  }
  constexpr std::size_t k_rows = k_side / k_wide;
  for (std::size_t y = 0; y < k_rows; ++y) {
#pragma GCC unroll 8
    for (std::size_t x = 0; x < k_side; ++x) {
      const auto at = [&](std::size_t s) __attribute__((always_inline)) {
        return blend<step>(weights, x, &by_plane[s][0][y], k_rows);
      };
      store(distance_of<Wide>(shape, {at(0), {at(1), at(2), at(3)}, at(4)}),
            to + (x * k_rows + y) * k_wide * k_side);
    }
  }
}

void fill_block(const SurfaceShape& shape, const NodeWeights& weights, const NodeRows& nodes,
                float* to) noexcept {
  if (weights.step == 2) return fill_between<2>(shape, weights, nodes, to);
  fill_between<4>(shape, weights, nodes, to);
}

void sphere_distances(const SurfaceShape& shape, const float* squares, std::size_t n, float* to) noexcept {
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const Floats distance = square_root(load(squares + k)) - shape.offset;
    store(cut(shape, distance * (1.0f / shape.voxel_size)), to + k);
  }
}

void moments_at_points(ConstVectors points, std::size_t n, ConstVectors particles, std::size_t count,
                       float* moments) noexcept {
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const ClusterVec3 x = load(points, k);
    Floats m[k_moments] = {};
    for (std::size_t i = 0; i < count; ++i) {
      const ClusterVec3 d = difference(particles, i, x);
      const Floats square = dot_from_left(d, d);
      const Floats w = larger(1.0f - square * square_root(square), Floats{});
      const ClusterVec3 wd = w * d;
      m[0] += w;
      m[1] += wd.x;
      m[2] += wd.y;
      m[3] += wd.z;
      m[4] += wd.x * d.x;
      m[5] += wd.x * d.y;
      m[6] += wd.x * d.z;
      m[7] += wd.y * d.y;
      m[8] += wd.y * d.z;
      m[9] += wd.z * d.z;
    }
    for (std::size_t s = 0; s < k_moments; ++s) store(m[s], moments + s * n + k);
  }
}

// The first order is taken of the fourth root, as the kernel's integral over a face is (1 − z²)⁴: its root is
// nearly straight where the density itself has a long tail.
void density_distances(const SurfaceShape& shape, const float* sums, std::size_t n, float* to) noexcept {
  for (std::size_t k = 0; k < n; k += k_cluster) {
    const Floats density = load(sums + k);
    const ClusterVec3 gradient = load(sums + n + k, n);
    const Floats slope = larger(square_root(dot_from_left(gradient, gradient)), all(k_least_slope));
    const Floats root = square_root(square_root(density));
    const Floats distance = (shape.threshold - root) * (4.0f / shape.voxel_size) * root * root * root / slope;
    const Ints body = is_larger(density, all(k_least_density));
    store(where(body, cut(shape, distance)) + where(~body, all(shape.background)), to + k);
  }
}

}  // namespace

extern const SurfaceLanes surface_lanes;
const SurfaceLanes surface_lanes = {distances,        find_sides,        fill_block,
                                    sphere_distances, moments_at_points, density_distances};

}  // namespace mallow::MALLOW_LEVEL

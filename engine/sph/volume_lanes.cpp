// The volume constraint of model 2, section 2: one Jacobi iteration of a divergence-free solver on what
// densities will be [Bender & Koschier 2015]. Departs from it: one solver in place of two, on the velocity
// that contact would leave, with half of what a particle alone would ask for.
#include "sph/volume_lanes.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

MALLOW_INLINE Floats not_negative(const Floats& value) {
  return larger(value, Floats{});
}

/// Which kinds of particles there are besides those of one group that move.
template <bool grouped_, bool pinned_>
struct Kinds {
  static constexpr bool grouped = grouped_, pinned = pinned_;
};

/// The particles of one cluster, and who is in their list.
template <class Kind>
struct ClusterPairs {
  const VolumeInput& in;
  const std::size_t first, count;  ///< its particles
  const std::uint32_t* const list;
  const std::uint32_t list_count;
  const ClusterVec3 x;
  Ints own = {};

  ClusterPairs(const VolumeInput& input, std::size_t cluster)
      : in(input),
        first(in.lists.first[cluster]),
        count(in.lists.first[cluster + 1] - first),
        list(in.lists.indices + in.lists.begin[cluster]),
        list_count(in.lists.count[cluster]),
        x(load(in.position, first)) {
    if (!Kind::grouped) return;
    own = Ints{} + static_cast<int>(in.group[first]);  // lanes without a particle too
    for (std::size_t l = 0; l < count; ++l) own[l] = static_cast<int>(in.group[first + l]);
  }

  /// Calls body(j, x_j − x_i, (1 − q)³).
  template <class Body>
  MALLOW_INLINE void for_each(const ClusterPairs& of, const Body& body) {
    const VolumeInput& in = of.in;
    const float inverse_square = in.inverse_radius * in.inverse_radius;
    for (std::uint32_t k = 0; k < of.list_count; ++k) {
      const std::uint32_t j = of.list[k];
      const ClusterVec3 d = difference(in.position, j, of.x);
      Floats t = not_negative(1.0f - square_root(dot_from_left(d, d) * inverse_square));
      if (Kind::grouped && in.apart) t = where(is_equal(of.own, static_cast<int>(in.group[j])), t);
      body(j, d, t * t * t);
    }
  }
  const VolumeGroup& group(std::size_t j) const { return in.groups[Kind::grouped ? in.group[j] : 0]; }
  float mobility(std::size_t j) const { return Kind::pinned ? in.mobile[j] : 1.0f; }
};

struct Sums {
  Floats rate = {};           ///< Σ ψ (w_i − w_j)·∇W
  ClusterVec3 gradient = {};  ///< Σ ψ ∇W
  Floats square = {};         ///< Σ ψ² |∇W|²/m_j
};

/// Without what particles of a single group share.
template <class Kind, bool responds>
Sums sum_rates(const VolumeInput& in, const ClusterPairs<Kind>& pairs) {
  const ClusterVec3 w = load(in.velocity, pairs.first);
  Sums sums;
  ClusterPairs<Kind>::for_each(pairs, [&](std::uint32_t j, const ClusterVec3& d, Floats t3) {
    if (Kind::grouped) t3 = pairs.group(j).slope * t3;
    sums.rate -= t3 * dot_from_left(difference(in.velocity, j, w), d);
    if (!responds) return;
    const ClusterVec3 gradient = t3 * d;
    sums.gradient += gradient;
    const Floats square = dot_from_left(gradient, gradient);
    if (Kind::grouped)
      sums.square += pairs.mobility(j) * pairs.group(j).inverse_mass * square;
    else
      sums.square += Kind::pinned ? in.mobile[j] * square : square;
  });
  return sums;
}

float squared_length(float x, float y, float z) {
  return x * x + y * y + z * z;
}

template <class Kind>
float response_of(const VolumeInput& in, const VolumeGroup& own, const Sums& sums, std::size_t l,
                  std::size_t row) {
  const float scale = Kind::grouped ? 1.0f : own.slope;
  float g[3] = {scale * sums.gradient.x[l], scale * sums.gradient.y[l], scale * sums.gradient.z[l]};
  if (in.wall_gradient.x) {
    g[0] += in.wall_gradient.x[row];
    g[1] += in.wall_gradient.y[row];
    g[2] += in.wall_gradient.z[row];
  }
  float others = Kind::grouped ? sums.square[l] : scale * scale * own.inverse_mass * sums.square[l];
  // What is behind a wall answers as those before it do: without, a fluid between walls never came to rest.
  if (in.wall_share) {
    const float open = 1 - in.wall_share[row];
    others /= open > 0.5f ? open : 0.5f;
  }
  const float response = squared_length(g[0], g[1], g[2]) * own.inverse_mass + others;
  return response > own.least_response ? response : own.least_response;
}

template <class Kind, bool responds>
void find_multipliers(const VolumeInput& in, std::size_t cluster, float* response, float* multiplier,
                      CompressionSum& total) {
  const ClusterPairs<Kind> pairs(in, cluster);
  const Sums sums = sum_rates<Kind, responds>(in, pairs);
  for (std::size_t l = 0; l < pairs.count; ++l) {
    const std::size_t i = pairs.first + l, row = in.lists.row_of[i];
    const VolumeGroup& own = pairs.group(i);
    if (responds) response[i] = response_of<Kind>(in, own, sums, l, row);
    float rate = Kind::grouped ? sums.rate[l] : own.slope * sums.rate[l];
    if (in.wall_rate) rate += in.wall_rate[row];
    const float excess = in.density[i] * own.inverse_rest_density - 1.0f + in.time_step * rate;
    const float s = (excess > 0 ? excess : 0.0f) * pairs.mobility(i);
    multiplier[i] = own.relaxation * s / (in.time_step * response[i]);
    total.sum += static_cast<double>(s);
    total.largest = s > total.largest ? s : total.largest;
  }
}

template <class Kind>
CompressionSum all_compressions(const VolumeInput& in, std::size_t begin, std::size_t end, bool first,
                                float* response, float* multiplier) {
  CompressionSum total{};
  for (std::size_t cluster = begin; cluster < end; ++cluster)
    if (first)
      find_multipliers<Kind, true>(in, cluster, response, multiplier, total);
    else
      find_multipliers<Kind, false>(in, cluster, response, multiplier, total);
  return total;
}

CompressionSum compressions(const VolumeInput& in, std::size_t begin, std::size_t end, bool first,
                            float* response, float* multiplier) noexcept {
  const auto sum =
      in.group ? (in.mobile ? all_compressions<Kinds<true, true>> : all_compressions<Kinds<true, false>>)
               : (in.mobile ? all_compressions<Kinds<false, true>> : all_compressions<Kinds<false, false>>);
  return sum(in, begin, end, first, response, multiplier);
}

template <class Kind>
void push_cluster(const VolumeInput& in, std::size_t cluster, const float* multiplier,
                  const Vectors& velocity, const Vectors& changes) {
  const ClusterPairs<Kind> pairs(in, cluster);
  const Floats own = load(multiplier + pairs.first);
  Floats own_slope = {};
  for (std::size_t l = 0; l < pairs.count; ++l) own_slope[l] = pairs.group(pairs.first + l).slope;
  ClusterVec3 sum = {};
  ClusterPairs<Kind>::for_each(pairs, [&](std::uint32_t j, const ClusterVec3& d, const Floats& t3) {
    if (Kind::grouped)
      sum += (t3 * (own * pairs.group(j).slope + multiplier[j] * own_slope)) * d;
    else
      sum += (t3 * (own + multiplier[j])) * d;
  });
  for (std::size_t l = 0; l < pairs.count; ++l) {
    const std::size_t i = pairs.first + l, row = in.lists.row_of[i];
    const VolumeGroup& group = pairs.group(i);
    const float scale = -(Kind::grouped ? 1.0f : group.slope) * group.inverse_mass * pairs.mobility(i);
    const float change[3] = {scale * sum.x[l], scale * sum.y[l], scale * sum.z[l]};
    velocity.x[row] += change[0];
    velocity.y[row] += change[1];
    velocity.z[row] += change[2];
    if (!changes.x) continue;
    changes.x[row] = change[0];
    changes.y[row] = change[1];
    changes.z[row] = change[2];
  }
}

template <class Kind>
void push_all(const VolumeInput& in, std::size_t begin, std::size_t end, const float* multiplier,
              const Vectors& velocity, const Vectors& changes) {
  for (std::size_t cluster = begin; cluster < end; ++cluster)
    push_cluster<Kind>(in, cluster, multiplier, velocity, changes);
}

void push(const VolumeInput& in, std::size_t begin, std::size_t end, const float* multiplier,
          Vectors velocity, Vectors changes) noexcept {
  const auto add = in.group ? (in.mobile ? push_all<Kinds<true, true>> : push_all<Kinds<true, false>>)
                            : (in.mobile ? push_all<Kinds<false, true>> : push_all<Kinds<false, false>>);
  add(in, begin, end, multiplier, velocity, changes);
}

}  // namespace

extern const VolumeLanes volume_lanes;
const VolumeLanes volume_lanes = {compressions, push};

}  // namespace mallow::MALLOW_LEVEL

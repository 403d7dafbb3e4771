// SPH sums of model section 1: Mueller, Charypar & Gross 2003 in pairwise form, and [TK eq. 1, 2] as printed.
// Departs from [TK]: densities sum rest volumes, so that a light body is not pushed off by heavy neighbours
// (Solenthaler & Pajarola 2008); pressure and viscosity are antisymmetric, so that momentum is kept.
#include "sph/sph_lanes.h"

#include "core/cluster_lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

MALLOW_INLINE Floats squared_length(const ClusterVec3& d) {
  return dot_from_left(d, d);
}
MALLOW_INLINE Floats not_negative(const Floats& value) {
  return larger(value, Floats{});
}

/// Of each particle of a cluster; lanes without one have that of the first.
Ints groups_of(const SphInput& in, std::size_t cluster) {
  const std::size_t first = in.lists.first[cluster];
  Ints own = Ints{} + static_cast<int>(in.group[first]);
  for (std::size_t i = first; i < in.lists.first[cluster + 1]; ++i)
    own[i - first] = static_cast<int>(in.group[i]);
  return own;
}

/// Σ_j of the densities of a cluster. `near`: null, or where to write who of the list is near some particle
/// of the cluster, which may be the list itself; their number is written to `count`.
template <DensityKernel kernel, bool grouped, bool apart, bool listed>
Floats sum_density(const SphInput& in, std::size_t cluster, std::uint32_t* near, std::uint32_t& count) {
  const std::uint32_t* const list = in.lists.indices + in.lists.begin[cluster];
  const std::uint32_t n = in.lists.count[cluster];
  const ClusterVec3 x = load(in.position, in.lists.first[cluster]);
  const float inverse_square = in.inverse_radius * in.inverse_radius;
  Floats sum = {};
  std::uint32_t found = 0;
  Ints own = {};
  if (apart) own = groups_of(in, cluster);
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t j = list[k];
    constexpr bool smooth = kernel == DensityKernel::poly6;
    const Floats q2 = squared_length(difference(in.position, j, x)) * inverse_square;
    const Floats q = smooth ? Floats{} : square_root(q2);
    Floats t = not_negative(1.0f - (smooth ? q2 : q));
    if (apart) t = where(is_equal(own, static_cast<int>(in.group[j])), t);
    const Floats w = smooth ? t * t * t : (t * t) * (t * t) * (1.0f + 4.0f * q);
    sum += grouped ? in.groups[in.group[j]].kernel_volume * w : w;
    if (!listed) continue;
    // Always written, kept only if near: no branch to predict.
    near[found] = j;
    found += any(is_larger(t, Floats{}));
  }
  if (listed) count = found;
  return sum;
}

template <DensityKernel kernel>
auto choose_sum(bool grouped, bool apart, bool listed) {
  return listed ? (!grouped ? sum_density<kernel, false, false, true>
                   : apart  ? sum_density<kernel, true, true, true>
                            : sum_density<kernel, true, false, true>)
                : (!grouped ? sum_density<kernel, false, false, false>
                   : apart  ? sum_density<kernel, true, true, false>
                            : sum_density<kernel, true, false, false>);
}

void density(const SphInput& in, std::size_t begin, std::size_t end, const NearLists& near, float* rho,
             float* pressure, float* volume, float* rho_by_row) noexcept {
  const bool grouped = in.group != nullptr, listed = near.indices != nullptr;
  const auto sum = in.kernel == DensityKernel::wendland
                       ? choose_sum<DensityKernel::wendland>(grouped, in.apart, listed)
                       : choose_sum<DensityKernel::poly6>(grouped, in.apart, listed);
  for (std::size_t cluster = begin; cluster < end; ++cluster) {
    std::uint32_t unused = 0;
    const Floats sums = sum(in, cluster, listed ? near.indices + in.lists.begin[cluster] : nullptr,
                            listed ? near.count[cluster] : unused);
    const std::size_t first = in.lists.first[cluster];
    for (std::size_t i = first; i < in.lists.first[cluster + 1]; ++i) {
      const SphGroup& own = in.groups[grouped ? in.group[i] : 0];
      const float density = grouped ? sums[i - first] : sums[i - first] * own.kernel_volume;
      rho[i] = own.rest_density * (in.density_factor * density);
      if (in.wall_share) rho[i] += own.rest_density * in.wall_share[in.lists.row_of[i]];
      const float p = own.pressure_coefficient * (rho[i] - own.rest_density);
      pressure[i] = p < 0 ? p * own.cohesion : p;
      volume[i] = own.mass / rho[i];
      rho_by_row[in.lists.row_of[i]] = rho[i];
    }
  }
}

/// Of eight i beside one j: both formulations are a_i = (F/ρ_i) Σ_j V_j t (...), each with its own falloff t.
struct Sides {
  Floats own_pressure;
  float pressure, volume;  ///< p_j, V_j
  Floats viscosity;        ///< μ_i + μ_j, twice their mean
  /// In the viscous term of Conservative: the share of each i there, and the volume of j, see sum_pairs().
  Floats own_share;
  float viscous_volume;
  ClusterVec3 velocity;  ///< v_j − v_i, or v_j
};

/// What squared distances are at least when something is divided by them: far below those of particles that
/// are not in one point [m²].
constexpr float k_least = 1e-30f;

/// x_j − x_i of eight i, and what takes long to find from it.
struct Separation {
  ClusterVec3 d;
  Floats r, inverse_square;
};

/// t = σ − r, so F = |∇W_spiky|/(2 σ²) at q = 0, and ∇²W_visc is twice that times t σ. Model 1, Mueller 2003.
/// Viscosity acts along the pair alone, five times as strong: the same shear viscosity, and spin is kept. All
/// three components of the velocity took 28% of a free cube's spin in 200 steps. There ρ is at least ρ0.
/// [model 2, section 0]
struct Conservative {
  [[maybe_unused]] static constexpr bool central = true, looks_ahead = true;
  static float factor(const SphInput& in) {
    return 0.5f * in.spiky_gradient * in.inverse_radius * in.inverse_radius;
  }

  MALLOW_INLINE Separation separate(const SphInput&, const ClusterVec3& d) {
    const Floats r2 = squared_length(d);
    // 1/r as r/r², which need not wait for the root; 0 for coincident particles, which have no direction to
    // push in.
    return {d, square_root(r2), 1.0f / larger(r2, all(k_least))};
  }

  /// What both terms share is taken last: t/r² times (x_i − x_j).
  template <bool viscous>
  MALLOW_INLINE ClusterVec3 acceleration(const SphInput& in, const Separation& apart, const Sides& sides) {
    const ClusterVec3& d = apart.d;
    const Floats t = not_negative(in.radius - apart.r);
    Floats push = (sides.volume * (sides.own_pressure + sides.pressure)) * (t * apart.r);
    if (viscous) {
      const ClusterVec3& w = sides.velocity;
      push -= sides.own_share * sides.viscous_volume * (5.0f * sides.viscosity) * dot_from_left(w, d);
    }
    push *= t * apart.inverse_square;
    return -(push * d);
  }
};

#ifdef MALLOW_NATIVE
/// σ − r and 1/r in place of r and 1/r².
struct RoughSeparation {
  ClusterVec3 d;
  Floats falloff, inverse;
};

/// The same from a rough 1/r: neither a root nor a quotient. What both terms share is t/r times (x_i − x_j).
struct ConservativeNative {
  static constexpr bool central = true, looks_ahead = false;
  static float factor(const SphInput& in) { return Conservative::factor(in); }

  MALLOW_INLINE RoughSeparation separate(const SphInput& in, const ClusterVec3& d) {
    const Floats r2 = squared_length(d);
    // Nearer than 1e-6 σ, pushes fade away: coincident particles have no direction.
    const Floats inverse = rough_inverse_root(larger(r2, all(1e-12f * in.radius * in.radius)));
    return {d, not_negative(in.radius - r2 * inverse), inverse};
  }

  template <bool viscous>
  MALLOW_INLINE ClusterVec3 acceleration(const SphInput&, const RoughSeparation& apart, const Sides& sides) {
    Floats push = (sides.volume * (sides.own_pressure + sides.pressure)) * apart.falloff;
    if (viscous) {
      const Floats drag = sides.viscous_volume * (5.0f * sides.viscosity * sides.own_share);
      push -= drag * apart.inverse * dot_from_left(sides.velocity, apart.d);
    }
    push *= apart.falloff * apart.inverse;
    return -(push * apart.d);
  }
};
using Pairs = ConservativeNative;
#else
using Pairs = Conservative;
#endif

/// F = |∇W_poly6/r| = |∇²W_poly6|/3 at q = 0. [TK eq. 1, 2]
struct Printed {
  static constexpr bool central = false, looks_ahead = true;
  static float factor(const SphInput& in) { return in.poly6_gradient; }

  MALLOW_INLINE Separation separate(const SphInput&, const ClusterVec3& d) { return {d, Floats{}, Floats{}}; }

  template <bool viscous>
  MALLOW_INLINE ClusterVec3 acceleration(const SphInput& in, const Separation& apart, const Sides& sides) {
    const ClusterVec3 &d = apart.d, &w = sides.velocity;
    const Floats q2 = squared_length(d) * (in.inverse_radius * in.inverse_radius);
    const Floats t = not_negative(1.0f - q2), weight = sides.volume * t, push = weight * (sides.pressure * t);
    if (!viscous) return -(push * d);
    const Floats drag = weight * (-0.5f * sides.viscosity * (3.0f - 7.0f * q2));
    return drag * w - push * d;
  }
};

/// Σ_j of a cluster's pairs within their groups and with others, without F/ρ. owned: particles have alpha or
/// viscosities of their own.
template <class Formula, bool viscous, bool grouped, bool owned>
void sum_pairs(const SphInput& in, std::size_t cluster, const float* pressures, const float* volumes,
               ClusterVec3& same, ClusterVec3& cross) {
  const std::size_t first = in.lists.first[cluster];
  const std::uint32_t* const list = in.lists.indices + in.lists.begin[cluster];
  const std::uint32_t n = in.lists.count[cluster];
  if (n == 0) return;  // not even themselves: their positions are no numbers
  const ClusterVec3 x = load(in.position, first);
  const Floats own_pressure = load(pressures + first);
  ClusterVec3 v = {};
  if (viscous && Formula::central) v = load(in.velocity, first);
  Ints own = Ints{} + (grouped ? static_cast<int>(in.group[first]) : 0);  // lanes without a particle too
  Floats own_viscosity = all(in.groups[0].viscosity), own_rest = all(in.groups[0].rest_volume);
  Floats touching_pressure = {}, half_alpha = {};
  if (owned && in.alpha) half_alpha = 0.5f * load(in.alpha + first);
  if (grouped) {
    for (std::size_t i = first; i < in.lists.first[cluster + 1]; ++i) {
      const SphGroup& group = in.groups[in.group[i]];
      own[i - first] = static_cast<int>(in.group[i]);
      own_viscosity[i - first] = group.viscosity;
      own_rest[i - first] = group.rest_volume;
      touching_pressure[i - first] = pressures[i] * group.contact_share;
    }
  }
  if (owned && in.viscosity) own_viscosity = load(in.viscosity + first);
  // Where there are few neighbours, viscosity takes the rest density for the density: with its own a thin
  // place would be the stiffer the thinner it is, beyond what the limit on the step knows of.
  const Floats own_volume = load(volumes + first);
  const Floats own_share = smaller(own_rest / larger(own_volume, all(k_least)), all(1.0f));
  const auto add_pairs = [&](std::uint32_t j, const auto& apart) {
    const int number = grouped ? static_cast<int>(in.group[j]) : 0;
    const SphGroup& group = in.groups[number];
    Sides sides{own_pressure, pressures[j], volumes[j], own_viscosity + group.viscosity, own_share, 0, {}};
    if (owned && in.viscosity) sides.viscosity = own_viscosity + in.viscosity[j];
    if (viscous) sides.velocity = difference(in.velocity, j, v);
    if (viscous && Formula::central)
      sides.viscous_volume = volumes[j] < group.rest_volume ? volumes[j] : group.rest_volume;
    ClusterVec3 a = Formula::template acceleration<viscous>(in, apart, sides);
    if (owned && in.alpha) a = (half_alpha + 0.5f * in.alpha[j]) * a;
    // Where groups do not touch, which is nearly everywhere, the branch is foreseen.
    const Ints alike = is_equal(own, number);
    if (grouped && any(~alike)) {
      same += where(alike, a);
      if (in.apart) return;
      sides.own_pressure = touching_pressure;
      sides.pressure *= group.contact_share;
      cross += where(~alike, Formula::template acceleration<viscous>(in, apart, sides));
    } else {
      same += a;
    }
  };
  const auto separate = [&](std::uint32_t j) { return Formula::separate(in, difference(in.position, j, x)); };
  if constexpr (!Formula::looks_ahead) {
#pragma GCC unroll 2
    for (std::uint32_t k = 0; k < n; ++k) add_pairs(list[k], separate(list[k]));
    return;
  }
  // The root and the quotient of the next pair are under way while this one's are used: left in one piece,
  // the chain of a pair is longer than what a processor looks ahead.
  auto apart = separate(list[0]);
#pragma GCC unroll 2
  for (std::uint32_t k = 0; k + 1 < n; ++k) {
    const auto next = separate(list[k + 1]);
    add_pairs(list[k], apart);
    apart = next;
  }
  add_pairs(list[n - 1], apart);
}

void write_by_row(const SphInput& in, std::size_t cluster, const Floats& scale, const ClusterVec3& sum,
                  const Vectors& to) {
  const ClusterVec3 a = scale * sum;
  const std::size_t first = in.lists.first[cluster];
  for (std::size_t i = first; i < in.lists.first[cluster + 1]; ++i) {
    const std::uint32_t row = in.lists.row_of[i];
    to.x[row] = a.x[i - first];
    to.y[row] = a.y[i - first];
    to.z[row] = a.z[i - first];
  }
}

template <class Formula, bool viscous, bool grouped, bool owned>
void sum_clusters(const SphInput& in, std::size_t begin, std::size_t end, const float* rho,
                  const float* pressure, const float* volume, const Vectors& same, const Vectors& cross) {
  for (std::size_t cluster = begin; cluster < end; ++cluster) {
    ClusterVec3 own = {}, other = {};
    sum_pairs<Formula, viscous, grouped, owned>(in, cluster, pressure, volume, own, other);
    const Floats density = load(rho + in.lists.first[cluster]);
    // Plus 0, or what is not a number where the density is infinite and the quotient would hide it.
    const Floats scale = Formula::factor(in) / density + (density - density);
    write_by_row(in, cluster, scale, own, same);
    if (grouped && !in.apart) write_by_row(in, cluster, scale, other, cross);
  }
}

template <class Formula, bool owned>
auto choose_sum(const SphInput& in) {
  const bool viscous = in.velocity.x != nullptr, grouped = in.group != nullptr;
  return viscous ? (grouped ? sum_clusters<Formula, true, true, owned>
                            : sum_clusters<Formula, true, false, owned>)
                 : (grouped ? sum_clusters<Formula, false, true, owned>
                            : sum_clusters<Formula, false, false, owned>);
}

template <class Formula>
void accelerations(const SphInput& in, std::size_t begin, std::size_t end, const float* rho,
                   const float* pressure, const float* volume, Vectors same, Vectors cross) noexcept {
  const auto sum = in.alpha || in.viscosity ? choose_sum<Formula, true>(in) : choose_sum<Formula, false>(in);
  sum(in, begin, end, rho, pressure, volume, same, cross);
}

}  // namespace

extern const SphLanes sph_lanes;
const SphLanes sph_lanes = {density, accelerations<Pairs>, accelerations<Printed>};

}  // namespace mallow::MALLOW_LEVEL

#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"
#include "neighbors/cluster_lists.h"
#include "sph/kernel_functions.h"

namespace mallow {

/// Material constants of one group, as pairs read them.
struct SphGroup {
  float mass;                  ///< m [kg]
  float rest_density;          ///< ρ0 [kg/m³]
  float rest_volume;           ///< m/ρ0 [m³]
  float kernel_volume;         ///< the same, times what makes its lattice as dense by Wendland's kernel [m³]
  float pressure_coefficient;  ///< k [m²/s²]
  float contact_share;         ///< share of the pressure that acts between groups
  float viscosity;             ///< μ [Pa s]
  float cohesion;              ///< share of negative pressure
};

/// Sums over all particles within σ. All columns are in sorted order unless they say row. The particles of a
/// cluster share one list, which holds all that are within σ of one of them, and are summed lane by lane:
/// who is farther than σ from a lane's particle adds nothing to it [Pall & Hess 2013].
///
/// symbol | column        | unit    | eq.
/// x_i    | position      | m       |
/// v_i    | velocity      | m/s     |
/// ρ_i    | density       | kg/m³   | model 1, [TK eq. 3]
/// p_i    | pressure      | Pa      | model 1
/// V_j    | volume, m_j/ρ_j | m³    |
/// α_i    | alpha         | 1       | where particles of a body differ in it; model 2, section 7
struct SphInput {
  ClusterLists lists;
  const std::uint32_t* group;  ///< null: all in group 0
  const SphGroup* groups;
  bool apart;               ///< pairs of two groups add nothing: contact between bodies is not by pressure
  DensityKernel kernel;     ///< of densities
  const float* wall_share;  ///< of the volume around a particle, by row; null: no wall is near any
  ConstVectors position;
  ConstVectors velocity;   ///< accelerations only; null without viscosity
  const float* alpha;      ///< α_i, accelerations only; null: sums of one group are not blended
  const float* viscosity;  ///< μ_i [Pa s]; null: that of their groups
  float radius;            ///< σ [m]
  float inverse_radius;    ///< 1/σ
  float density_factor;    ///< KernelFactors
  float spiky_gradient;
  float poly6_gradient;
};

/// Where the first sum over the lists leaves who of them is near, for the sums that follow: the lists
/// themselves, or null where they must stay whole.
struct NearLists {
  std::uint32_t* indices;
  std::uint32_t* count;
};

/// [begin, end): clusters.
struct SphLanes {
  /// ρ_i = ρ0_i (Σ_j (m_j/ρ0_j) W_ij + wall_share), p_i = k (ρ_i − ρ0), negative ones times cohesion.
  /// Writes density, pressure and volume, and the density also by row.
  void (*density)(const SphInput&, std::size_t begin, std::size_t end, const NearLists& near, float* density,
                  float* pressure, float* volume, float* density_by_row) noexcept;
  /// a_i = (1/ρ_i) Σ_j V_j [ (p_i + p_j)/2 |∇W_spiky| r̂ + 5 μ ((v_j − v_i)·r̂) r̂ ∇²W_visc ], by row: pairs of
  /// one group into `same`, pairs of two groups, μ the mean of theirs and pressures times their
  /// contact_share, into `cross` (null where there is one group, or where groups are apart). In the viscous
  /// term ρ is at least ρ0. [model 1; model 2, section 0] With `alpha` each pair of one group counts
  /// (α_i + α_j)/2 times, which is as much for both: momentum is kept. [model 2, section 7]
  void (*conservative)(const SphInput&, std::size_t begin, std::size_t end, const float* density,
                       const float* pressure, const float* volume, Vectors same, Vectors cross) noexcept;
  /// [TK eq. 1, 2] to the letter: a_i = (1/ρ_i) Σ_j V_j [ −p_j ∇W_poly6 + μ v_j ∇²W_poly6 ], j = i included.
  void (*printed)(const SphInput&, std::size_t begin, std::size_t end, const float* density,
                  const float* pressure, const float* volume, Vectors same, Vectors cross) noexcept;
};
MALLOW_DECLARE_LEVELS(SphLanes, sph_lanes)
MALLOW_DECLARE_NATIVE_LEVELS(SphLanes, sph_lanes)

}  // namespace mallow

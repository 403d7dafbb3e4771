#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"
#include "neighbors/cluster_lists.h"

namespace mallow {

/// What pairs read of one group, in units that keep single precision whatever those of the scene are.
struct VolumeGroup {
  float slope;                 ///< ψ |∇W/r| at r = 0, with ψ that of SphGroup::kernel_volume [1/m²]
  float inverse_mass;          ///< 1/m [1/kg]
  float inverse_rest_density;  ///< 1/ρ0 [m³/kg]
  float relaxation;            ///< share of what a particle alone would ask for, of the step
  float least_response;        ///< what D is at least: half of that in its lattice [1/(m² kg)]
};

/// Sums over all particles within σ, by cluster as those of sph_lanes.h. In sorted order unless they say row.
///
/// symbol | column        | unit       | what
/// x_i    | position      | m          |
/// w_i    | velocity      | m/s        | what contact would make of v'
/// ρ_i    | density       | kg/m³      |
/// D_i    | response      | 1/(m² kg)  | by how much a push changes the own rate of compression
/// s_i    |               | 1          | compression at the end of the step
/// λ_i    | multiplier    | m² kg/s    |
/// S, ∇S, dS/dt | wall_share, wall_gradient, wall_rate | 1, 1/m, 1/s | what walls hold of its kernel, by row
struct VolumeInput {
  ClusterLists lists;
  const std::uint32_t* group;  ///< null: all in group 0
  const VolumeGroup* groups;
  bool apart;           ///< pairs of two groups add nothing
  const float* mobile;  ///< 0 where it is pinned, else 1; null: none is pinned
  const float* density;
  ConstVectors position;
  ConstVectors velocity;
  ConstVectors wall_gradient;  ///< null: no wall is near any
  const float* wall_rate;
  const float* wall_share;  ///< S
  float inverse_radius;     ///< 1/σ
  float time_step;          ///< Δt [s]
};

/// Of some particles.
struct CompressionSum {
  double sum;     ///< Σ s_i
  float largest;  ///< max s_i
};

/// [begin, end): clusters. With ψ of particle j's own group and ∇W of Wendland's kernel [Bender & Koschier
/// 2015; model 2, section 2]:
struct VolumeLanes {
  /// s_i = max(0, ρ_i/ρ0 − 1 + Δt (Σ_j ψ_j (w_i − w_j)·∇W_ij + dS/dt)), λ_i = relaxation s_i/(Δt D_i), 0
  /// where it is pinned. Where `first`, writes also D_i = |Σ_j ψ_j ∇W_ij +
  /// ∇S|²/m_i + Σ_j ψ_j² |∇W_ij|²/((1 − S) m_j) over j that are not pinned, with S at most ½; else reads
  /// both.
  CompressionSum (*compressions)(const VolumeInput&, std::size_t begin, std::size_t end, bool first,
                                 float* response, float* multiplier) noexcept;
  /// v_i −= (1/m_i) Σ_j (λ_i ψ_j + λ_j ψ_i) ∇W_ij where i is not pinned, by row. changes: the same, by row;
  /// null where nobody asks.
  void (*push)(const VolumeInput&, std::size_t begin, std::size_t end, const float* multiplier,
               Vectors velocity, Vectors changes) noexcept;
};
MALLOW_DECLARE_LEVELS(VolumeLanes, volume_lanes)
MALLOW_DECLARE_NATIVE_LEVELS(VolumeLanes, volume_lanes)

}  // namespace mallow

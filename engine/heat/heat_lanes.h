#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"
#include "neighbors/cluster_lists.h"

namespace mallow {

/// What pairs read of a group of SPH.
struct HeatGroup {
  float conductivity = 0;  ///< κ [W/(m K)]; 0: no heat
  float factor = 0;        ///< h C of HeatLattice [m]
  float touch = 0;         ///< distance up to which it touches particles of other groups [m]
};

/// Heat between all particles within σ, over the lists of SPH: the same for both of a pair but for its sign,
/// so that none is lost. What two materials conduct is the harmonic mean, as if each filled half of the way
/// [Cleary & Monaghan 1999]. Particles of two groups exchange heat where they touch.
///
/// symbol | column      | unit    |
/// x_i    | position    | m       | sorted
/// T_i    | temperature | K       | sorted
/// κ_i    | conductivity of its group | W/(m K) |
/// q_i    | flow        | W       | by row: Σ_j G_ij (T_j − T_i)
///        | conductance | W/K     | by row: Σ_j G_ij
struct HeatInput {
  ClusterLists lists;
  const std::uint32_t* group;  ///< null: all in group 0
  const HeatGroup* groups;
  ConstVectors position;
  const float* temperature;
  const float* openness;  ///< sorted: see HeatLattice::open; pairs count the mean of the two times
  float inverse_radius;   ///< 1/σ [1/m]
};

struct HeatLanes {
  /// [begin, end): clusters.
  void (*flows)(const HeatInput&, std::size_t begin, std::size_t end, float* flow,
                float* conductance) noexcept;
};
MALLOW_DECLARE_LEVELS(HeatLanes, heat_lanes)

}  // namespace mallow

#pragma once

#include "colliders/collider_lanes.h"
#include "core/isa.h"
#include "core/raw_columns.h"

namespace mallow {

/// What acts on the particles of one group. All columns are by row of the store, but for the pull; those
/// whose x is null are terms that the scene does not have and are not read.
///
/// symbol   | column           | unit | eq.
/// x, v     | position, velocity | m, m/s | at the start of the step
/// a^SPH    | sph_acceleration | m/s² | model 1
/// a_ext    | gravity + cross_group + walls + user | m/s² | model 4, contact not in it
/// g − x    | pull             | m    | model 2, by row of the group
struct ForcesInput {
  ConstVectors position;
  ConstVectors velocity;
  ConstVectors sph_acceleration;
  ConstVectors cross_group;
  ConstVectors walls;
  ConstVectors user;
  ConstVectors pull;
  std::size_t group_begin;   ///< row of pull's first
  const std::uint16_t* pin;  ///< 0: free; null: all are
  float gravity[3];          ///< [m/s²]
  float time_step;           ///< Δt [s]
  float sph_factor;          ///< α Δt [s]
  float elastic_factor;      ///< (1 − α) Δt/(Δt0 Δt_SM) [1/s]
  /// Share of the difference between v and the body's rigid motion that goes in this step; 0 reads no more of
  /// it.
  float damping = 0;
  float center[3] = {}, velocity_of_center[3] = {}, spin[3] = {};  ///< [m], [m/s], [rad/s]
};

/// All of model section 4 but contact (engine/colliders). They write to no row outside [begin, end).
struct MotionLanes {
  /// v' before contact of free particles and of pinned ones alike, and what it says of the rows.
  BlockBounds (*blend)(const ForcesInput&, std::size_t begin, std::size_t end, Vectors velocity) noexcept;
  /// What blend says of rows whose velocities have changed since.
  BlockBounds (*bounds)(const ForcesInput&, std::size_t begin, std::size_t end,
                        ConstVectors velocity) noexcept;
  /// x' = x + Δt v'. Returns whether all that is new is finite.
  bool (*advance)(const ForcesInput&, std::size_t begin, std::size_t end, ConstVectors velocity,
                  Vectors position) noexcept;
  /// external[k] = |a_ext + (v' − free)/Δt| of row begin + k. free: v' before contact, from `begin` on.
  void (*external)(const ForcesInput&, std::size_t begin, std::size_t end, ConstVectors free,
                   ConstVectors velocity, float* external) noexcept;
  /// Largest |v + Δt (a^SPH + a_ext)|² of unpinned rows: NaN where one is, -1 where there is none.
  float (*fastest)(const ForcesInput&, std::size_t begin, std::size_t end) noexcept;
  /// The sixteen sums of RigidSums, in the order of its members, of `square` xx, xy, xz, yy, yz, zz. near:
  /// three numbers [m].
  void (*rigid_sums)(ConstVectors position, ConstVectors velocity, const double* near, std::size_t begin,
                     std::size_t end, double* sums) noexcept;
};
MALLOW_DECLARE_LEVELS(MotionLanes, motion_lanes)

}  // namespace mallow

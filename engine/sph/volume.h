#pragma once

#include <vector>

#include "colliders/contact.h"
#include "core/column.h"
#include "core/execution.h"
#include "sph/sph.h"
#include "sph/volume_lanes.h"

namespace mallow {

/// What the volume constraint owns; empty in a scene without it. It keeps densities from rising above those
/// at rest by what it does to velocities, over the lists and densities of the step. [model 2, section 2]
struct Volume {
  std::vector<VolumeGroup> groups;  ///< of Sph::groups
  // Sorted order of Sph.
  VectorColumn velocity;     ///< w
  Column<float> response;    ///< D [1/(m² kg)]
  Column<float> multiplier;  ///< λ [m² kg/s]
  Column<float> mobile;      ///< 0 where it is pinned, else 1; empty where nothing is
  // By row of the particle store; empty where no wall is near.
  VectorColumn wall_gradient;  ///< ∇S [1/m], 0 where no wall is near
  Column<float> wall_rate;     ///< dS/dt [1/s], likewise
  Column<float> multiplier_by_row;
  VectorColumn changes;  ///< of velocities, in one iteration [m/s]

  VectorColumn contacted;  ///< what contact makes of v', by row

  /// What walls got of it in this step, by block of walls and in it by collider [N s]; empty where nobody
  /// asks.
  std::vector<ColliderLoad> wall_loads;

  std::vector<CompressionSum> partial;  ///< scratch

  std::size_t bytes() const;
};

/// spacing: that of its bodies [m].
VolumeGroup volume_group(const SphGroup& group, float spacing, float support_radius);

/// What a step of it reads beside lists and densities.
struct VolumeStep {
  const VectorColumn& position;               ///< by row of the store
  const std::uint16_t* pin;                   ///< rows whose pin is not 0 are not pushed; null: all are
  std::span<const PlacedCollider> colliders;  ///< as they move in this step
  float time_step;                            ///< Δt [s]
  Vec3 gravity;                               ///< [m/s²]
  const float* alpha;                         ///< by row; null: that of each body
};

/// What an iteration finds before it changes anything.
struct Compression {
  double mean = 0;     ///< of s over all particles
  double largest = 0;  ///< of s
};

/// pins, walls -> what all iterations of a step share.
void begin_volume(const VolumeStep& step, const Sph& sph, const Execution& execution, Volume& volume);
/// velocity: w, by row of the store -> s and λ, and D where `first`.
Compression find_compression(const VolumeStep& step, const VectorColumn& velocity, bool first, const Sph& sph,
                             const Execution& execution, Volume& volume);
/// λ -> v' that compress less. A wall pushes as if the particle's own λ were behind it, and along as
/// press_walls() does.
void correct_velocities(const VolumeStep& step, Sph& sph, const Execution& execution, Volume& volume,
                        VectorColumn& velocity);

}  // namespace mallow

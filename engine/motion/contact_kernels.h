#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"

namespace mallow {

/// How near and how fast a contact is resolved in one step.
struct ContactStep {
  float time_step;       ///< Δt [s]
  float max_push;        ///< σ/(10 Δt0): speed at which a deep overlap is pushed out at the most [m/s]
  float contact_offset;  ///< gap at which a particle touches [m]
};

/// One primitive of a collider.
struct Obstacle {
  enum Kind { plane, sphere, box } kind;
  bool inside;  ///< it keeps particles in
  float a[3];   ///< unit normal, centre, least corner
  float b[3];   ///< offset, radius (in b[0]), greatest corner
};

/// Obstacles of which the nearest counts, and what is the same for all of them.
struct ObstacleSet {
  const Obstacle* parts;
  std::size_t count;
  float velocity[3];  ///< u [m/s]
  float restitution;  ///< e
  float friction;     ///< μ_f
};

/// Contact of model section 5, and whom it cannot concern. Rows are rows of the store.
struct ContactKernels {
  /// reach[k] = offset + Δt |v − u| of row begin + k: no surface that is farther is touched.
  void (*reach)(ConstVectors velocity, const float* surface_velocity, float time_step, float offset,
                std::size_t begin, std::size_t end, float* reach) noexcept;
  /// flags[k] |= 1 unless row begin + k is farther than reach[k] + slack from the obstacle.
  void (*mark)(const Obstacle&, ConstVectors position, float slack, std::size_t begin, std::size_t end,
               const float* reach, std::uint8_t* flags) noexcept;
  /// v of the listed rows becomes what resolve_contact makes of it, bit for bit, and fastest the largest |v|²
  /// of them where it is less. Rows at distances out of range (shapes/norm_range.h) are left as they are and
  /// become the first of the list; returns how many.
  std::size_t (*resolve)(const ObstacleSet&, const ContactStep&, ConstVectors position, std::uint32_t* rows,
                         std::size_t count, Vectors velocity, float& fastest) noexcept;
};
MALLOW_DECLARE_LEVELS(ContactKernels, contact_kernels)

}  // namespace mallow

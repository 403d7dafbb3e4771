#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"

namespace mallow {

/// How near and how fast a contact is resolved in one step.
struct ContactStep {
  float time_step;       ///< Δt [s]
  float max_push;        ///< σ/(10 Δt0): speed at which a deep overlap is pushed out at the most [m/s]
  float contact_offset;  ///< gap at which a particle touches [m]
  float gravity[3];      ///< g [m/s²]
  float least_bounce;    ///< 2 |g| Δt: what comes more slowly does not bounce, it rests [m/s]
};

/// A convex obstacle, or a ball that keeps particles in.
struct Obstacle {
  enum Kind { plane, sphere, box } kind;
  bool inside;  ///< a sphere keeps particles in
  float a[3];   ///< unit normal, centre, least corner
  float b[3];   ///< offset, radius (in b[0]), greatest corner
};

/// What all parts of a collider share.
struct ContactSurface {
  float velocity[3];  ///< u [m/s]
  float restitution;  ///< e
  float friction;     ///< μ_f
};

/// Looks that a way takes to find where it meets a convex obstacle, at most, and the share of the way that is
/// near enough. Each look goes on by the distance that is left, so it stops short of the obstacle; the plane
/// that is met there stands before all of the obstacle, so what is left can only be a particle that stops
/// short by less than that share, where it comes along a surface that is bent.
inline constexpr int k_most_looks = 16;
inline constexpr float k_near_enough = 1.0f / 64;

/// Contact of model 2, section 4 A, and whom it cannot concern. Rows are rows of the store.
struct ContactKernels {
  /// reach[k] = offset + Δt |v − u| of row begin + k: no surface that is farther is touched.
  void (*reach)(ConstVectors velocity, const float* surface_velocity, float time_step, float offset,
                std::size_t begin, std::size_t end, float* reach) noexcept;
  /// flags[k] |= 1 unless row begin + k is farther than reach[k] + slack from the obstacle.
  void (*mark)(const Obstacle&, ConstVectors position, float slack, std::size_t begin, std::size_t end,
               const float* reach, std::uint8_t* flags) noexcept;
  /// v of the listed rows becomes what resolve_contact makes of it at this obstacle, bit for bit, and fastest
  /// the largest |v|² of them where it is less. before: v^t. Rows at distances out of range
  /// (shapes/norm_range.h) are left as they are and become the first of the list; returns how many.
  std::size_t (*resolve)(const Obstacle&, const ContactSurface&, const ContactStep&, ConstVectors position,
                         ConstVectors before, std::uint32_t* rows, std::size_t count, Vectors velocity,
                         float& fastest) noexcept;
};
MALLOW_DECLARE_LEVELS(ContactKernels, contact_kernels)

}  // namespace mallow

#pragma once

#include "core/isa.h"
#include "core/raw_columns.h"

/// What lanes know of colliders: plain numbers, nothing inline (core/isa.h says why).
namespace mallow {

/// How near and how fast a contact is resolved in one step.
struct ContactStep {
  float time_step;       ///< Δt [s]
  float max_push;        ///< σ/(10 Δt0): speed at which a deep overlap is pushed out at the most [m/s]
  float contact_offset;  ///< gap at which a particle touches [m]
  float gravity[3];      ///< g [m/s²]
  float least_bounce;    ///< 2 |g| Δt: what comes more slowly does not bounce, it rests [m/s]
};

/// Within which a block of particles lies and how fast it is.
struct BlockBounds {
  float min[3], max[3];  ///< of the positions [m]
  float squared_speed;   ///< largest |v|² [m²/s²]
};

/// A shape as its lanes read it; what the numbers mean is said there. Lengths in m.
struct ShapeNumbers {
  float at[12];
  bool inside;                ///< particles are kept in
  const float* data[2] = {};  ///< what a heavy shape holds
  std::size_t sizes[3] = {};  ///< and how much of it
};

/// What all parts of a collider share. Where it does not turn, its shapes are given where they are, and
/// its rotations and `spin` are not read.
struct ContactSurface {
  float velocity[3];     ///< u [m/s]
  float along[3];        ///< of the surface itself, along it [m/s]
  bool carries;          ///< `along` is not 0
  float restitution;     ///< e
  float friction;        ///< μ_f
  bool turns;            ///< shapes are given in the frame of the collider
  float translation[3];  ///< c, where the frame has its origin [m]
  float rotation[9];     ///< R, from the frame to the world at the start of the step, row by row
  float turned[9];       ///< (1 + Δt Ω) R, the same at the end of the step
  float spin[9];         ///< Ω, row by row: the point at c + r moves by Δt (u + Ω r) in the step [1/s]
};

/// What a shape can do for the rows of the store: one table a shape, see collider_lanes.h.
struct ColliderLanes {
  /// Signed distance and its gradient, as nearest() of mallow/collider.h.
  void (*nearest)(const ShapeNumbers&, ConstVectors position, std::size_t begin, std::size_t end,
                  float* distance, Vectors normal) noexcept;
  /// Where it is above 0, no point between min and max is nearer to the shape, but for rounding.
  float (*least_distance)(const ShapeNumbers&, const float* min, const float* max) noexcept;
  /// flags[k] becomes 1 unless row begin + k is farther from the shape than offset + Δt |v − u| + slack, and
  /// so not touched. v is the velocity so far.
  void (*mark)(const ShapeNumbers&, const ContactSurface&, const ContactStep&, ConstVectors position,
               ConstVectors velocity, float slack, std::size_t begin, std::size_t end,
               std::uint8_t* flags) noexcept;
  /// v of the listed rows becomes what contact with the shape makes of it, and `fastest` the largest |v|² of
  /// them where it is less. before: v^t. [model 2, section 4 A]
  void (*resolve)(const ShapeNumbers&, const ContactSurface&, const ContactStep&, ConstVectors position,
                  ConstVectors before, const std::uint32_t* rows, std::size_t count, Vectors velocity,
                  float& fastest) noexcept;
  /// Signed distances of the listed rows and their gradients in the world, in the order of the list.
  void (*separate)(const ShapeNumbers&, const ContactSurface&, ConstVectors position,
                   const std::uint32_t* rows, std::size_t count, float* distance, Vectors normal) noexcept;
};

}  // namespace mallow

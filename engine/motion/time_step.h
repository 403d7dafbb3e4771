#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/column.h"
#include "core/execution.h"
#include "core/isa.h"
#include "core/range_blocks.h"
#include "particles/particle_store.h"

namespace mallow {

/// The fastest unpinned particle that SPH and external forces would make in a full step.
struct Fastest {
  float squared_velocity = -1;  ///< V² [m²/s²]; NaN and infinity count as fastest of all
  std::uint32_t row = 0;
};

/// What makes particles fast. Null columns are terms that the scene does not have.
struct FastestInput {
  /// The particles of one body, and the share of the acceleration by SPH that counts for them.
  struct Body {
    std::size_t begin, end;  ///< rows
    float share;
  };
  std::vector<Body> bodies;
  float time_step;                       ///< [s]
  Vec3 gravity;                          ///< [m/s²]
  const VectorColumn* sph_acceleration;  ///< [m/s²]
  const VectorColumn* cross_group;       ///< [m/s²]
  const VectorColumn* walls = nullptr;   ///< [m/s²]
  const VectorColumn* user;              ///< [m/s²]

  // Scratch.
  RangeBlocks blocks;
  std::vector<Fastest> partial;
};
/// V = max |v + Δt0 (share a^SPH + a_ext)|, contact not in a_ext. [model 3, TK eq. 12]
Fastest fastest_particle(const ParticleStore& store, const Execution& execution, FastestInput& input);

/// What bounds the step beside V.
struct TimeStepLimits {
  float time_step;       ///< Δt0 [s]
  float support_radius;  ///< σ [m]
  float farthest;        ///< way of the fastest particle [m]; σ in [TK eq. 12]
  bool acoustic;         ///< the limits of `pressures` count
  /// Of each body, as it acts.
  struct Pressure {
    float coefficient;          ///< α k, or k where it pushes other bodies [m²/s²]
    float kinematic_viscosity;  ///< α μ/ρ0, or μ/ρ0 likewise [m²/s]
    float stiffness;            ///< (1 − α)/(Δt0 Δt_SM) [1/s²]
    float pull = 0;             ///< of `coefficient` what draws, α k times cohesion [m²/s²]
    float damping_time = 0;     ///< τ [s]
    float damping_rate = 0;     ///< ζ, where it is given [1/s]
  };
  std::span<const Pressure> pressures;
  float viscous_time;  ///< smallest σ² ρ0/μ [s]; infinite without viscosity
};
/// Δt of model section 3.
double limited_time_step(const TimeStepLimits& limits, double max_velocity);

/// The fewest equal steps of at most `longest` seconds that `left` seconds take, at least 1. A step may be
/// longer than `longest` by a millionth: what rounding makes of a time that a whole number of steps fills
/// must not cost one more.
double steps_until(double left, double longest);
/// The length of each of so many equal steps: what they share evenly leaves no sliver for the last.
float share_of(double left, double steps);

}  // namespace mallow

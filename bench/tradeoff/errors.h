#pragma once

#include "harness/results.h"
#include "tradeoff/trajectory.h"

namespace mallow::bench {

/// How far a motion is from its reference, over all moments.
struct Errors {
  double position = 0;  ///< RMS over particles and moments [h]
  double height = 0;    ///< RMS of the highest particle's height [h]
  double spread = 0;    ///< RMS of the RMS horizontal distance from the middle [h]
  double density = 0;   ///< RMS over particles of ρ/ρ0 [1]
  double momentum = 0;  ///< RMS, in units of the largest momentum of the reference [1]
  double energy = 0;    ///< RMS of kinetic and potential energy, in units of the largest kinetic one [1]
};
Json to_json(const Errors& errors);

/// motion and reference: of the same particles, which lay `particle_spacing` [m] apart; as many moments as both
/// have. unit: h, that positions are told in [m].
Errors compare(const Trajectory& motion, const Trajectory& reference, const Vec3& gravity,
               double particle_spacing, double unit);

/// Change of momentum and angular momentum over `duration` [s] of a body that spins and breathes in free
/// flight, in units of Σ m |v| and Σ m |r| |v|: rounding, where the formulation keeps them.
struct Drift {
  double momentum = 0;
  double angular_momentum = 0;
};
Drift free_flight_drift(const Scene& scene, double duration, int threads);

}  // namespace mallow::bench

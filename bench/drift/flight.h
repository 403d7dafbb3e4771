#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mallow/simulation.h"

namespace mallow::bench {

/// A body in motion that engine and textbook can both be asked for.
struct DriftScene {
  std::string name;  ///< "paste, in free flight"
  SolverConfig config;
  Material material;
  Body body;
  std::vector<Collider> colliders = {};
};
/// Solid, paste and fluid, of 125 particles: in free flight, stirred, and fallen onto a floor; the paste at
/// 1e5 from the origin too.
std::vector<DriftScene> drift_scenes();

/// The scene with velocities off by up to 1e-6 m/s, which is about what single precision rounds a position by
/// in a step: how far that takes two motions apart is the scene's own doing.
DriftScene nudged(DriftScene scene);

/// Positions [m] and velocities [m/s] by id.
struct Snapshot {
  std::vector<Eigen::Vector3d> positions, velocities;
};
/// The scene's motion by the engine, in single precision: at its start and after each of `steps`, ascending.
std::vector<Snapshot> fly(const DriftScene& scene, const std::vector<int>& steps);
/// The scene's motion by the textbook, in double precision.
std::vector<Snapshot> fly_in_double(const DriftScene& scene, const std::vector<int>& steps);

/// Root mean square of distances by id [m].
double distance(const Snapshot& a, const Snapshot& b);

/// Sums over particles of equal masses, seen from a point at rest.
struct Balance {
  Eigen::Vector3d center{0, 0, 0};    ///< [m]
  Eigen::Vector3d momentum{0, 0, 0};  ///< a particle's share [m/s]
  Eigen::Vector3d spin{0, 0, 0};      ///< a particle's share [m²/s]
  double speed = 0;                   ///< mean [m/s]
  double moment = 0;                  ///< mean |x| |v| [m²/s]
  double energy = 0;                  ///< kinetic, and potential above z = 0, a particle's share [m²/s²]
};
Balance balance(const Snapshot& snapshot, const Eigen::Vector3d& from, const Eigen::Vector3d& gravity);

}  // namespace mallow::bench

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mallow/scene.h"

namespace mallow::bench {

/// Positions and velocities of all particles at one time, a row each, in id order.
struct Moment {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3>;
  Rows x;  ///< [m]
  Rows v;  ///< [m/s]
};

/// How a scene moved: moments `interval` apart, the first at the start.
struct Trajectory {
  double interval = 0;  ///< [s]
  std::vector<Moment> moments;
  std::uint64_t state_hash = 0;  ///< of the engine's last state
  std::string failure = {};      ///< why it ended early; empty where it did not

  bool complete(std::size_t count) const { return moments.size() == count; }
};

/// Runs the engine, or the textbook implementation, and takes `count` moments; between steps it is linear.
Trajectory run_engine(const Scene& scene, double interval, std::size_t count, int threads);
Trajectory run_textbook(const Scene& scene, double interval, std::size_t count, int threads);

/// Wall time that the engine takes to simulate a second [ms], first step left out.
double milliseconds_per_second(const Scene& scene, double duration, int threads);

/// A trajectory as the particles of another lattice in the same box would have had it: trilinear in the rest
/// position, and linear beyond the outermost particles.
Trajectory resampled(const Trajectory& trajectory, const Lattice& from, const Lattice& to);

}  // namespace mallow::bench

#pragma once

#include <optional>
#include <string>
#include <vector>

namespace mallow::bench {

/// A number that a test of data/scenes/standard gives for a material.
struct Measured {
  std::string quantity;  ///< "height [m]"
  double value = 0;
  std::optional<double> theory = {};  ///< where there is one
};

/// A material by name in one of the scenes, of particles `refined` times as fine as the file has them.
struct StandardTest {
  std::string scene;  ///< "drop", "squeeze", "slope"
  std::string material;
  int refined = 1;
  int threads = 1;
};

struct TestRun {
  double spacing = 0, time_step = 0;  ///< h [m], Δt0 [s]
  double seconds = 0;                 ///< that it took
  std::vector<Measured> measured;
};

/// Throws what a simulation throws.
TestRun run(const StandardTest& test);

}  // namespace mallow::bench

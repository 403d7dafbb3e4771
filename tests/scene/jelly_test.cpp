// The scene data/scenes/jelly_beside_jelly.toml: bodies of one kind that differ in Young's modulus.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "mallow/scene.h"
#include "mallow/simulation.h"

namespace mallow {
namespace jelly_test {

/// How far the middle of each jelly goes from where it stood on the tray, from one time to another [m].
std::array<double, 3> wobbles(Simulation& s, const std::array<double, 3>& stood, double until) {
  std::array<double, 3> most{};
  while (s.time() < until) {
    s.step();
    const double tray = s.colliders()[0].pose.translation.x();
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = s.motion(s.bodies()[k]).center_of_mass.x();
      most[k] = std::max(most[k], std::abs(x - tray - stood[k]));
    }
  }
  return most;
}

TEST(jelly, wobbles_the_farther_and_the_longer_the_softer_it_is) {
  Simulation s =
      build(read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/jelly_beside_jelly.toml"), 2);
  wobbles(s, {}, 0.6);
  std::array<double, 3> stood;
  for (std::size_t k = 0; k < 3; ++k) stood[k] = s.motion(s.bodies()[k]).center_of_mass.x();
  const std::array shaken = wobbles(s, stood, 1.4);
  const std::array after = wobbles(s, stood, 1.8);
  for (const auto& [soft, medium, firm] : {shaken, after}) {
    EXPECT_GT(soft, 3 * medium);
    EXPECT_GT(medium, 2 * firm);
  }
  EXPECT_GT(after[0], 0.9 * shaken[0]) << "the softest goes on";
  EXPECT_LT(after[2], 0.3 * shaken[2]) << "the firmest is still at once";
}

}  // namespace jelly_test
}  // namespace mallow

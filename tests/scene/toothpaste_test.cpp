// The scene data/scenes/toothpaste.toml: an emitter, plastic yield and the volume constraint together.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "mallow/scene.h"
#include "mallow/simulation.h"
#include "mallow/surface.h"
#include "meshes.h"

namespace mallow {
namespace toothpaste_test {

constexpr double k_pi = std::numbers::pi;
constexpr std::size_t k_layer = 29;  // particles of the strand beside each other

/// How the strand lies. Its layers are one behind the other in the order of identities, the first of which
/// came out first.
struct Path {
  double turns = 0;        ///< to the left less to the right, seen from above
  double bends = 0;        ///< to either side, in turns too
  double lying_speed = 0;  ///< mean of what lies on the table [m/s]
};
Path path_of(const Simulation& s, std::size_t layer, double spacing) {
  constexpr std::size_t k_chord = 4;  // layers over which a direction is taken
  const std::vector<Vec3> x = s.positions_by_id(), v = s.velocities_by_id();
  std::vector<Eigen::Vector3d> middle;
  Path path;
  std::size_t lying = 0;
  for (std::size_t i = 0; i + layer <= x.size(); i += layer) {
    Eigen::Vector3d at(0, 0, 0), speed(0, 0, 0);
    for (std::size_t k = i; k < i + layer; ++k) {
      at += x[k].cast<double>() / static_cast<double>(layer);
      speed += v[k].cast<double>() / static_cast<double>(layer);
    }
    middle.push_back(at);
    if (at.z() > 5.5 * spacing) continue;  // its diameter is 6
    path.lying_speed += speed.head<2>().norm();
    ++lying;
  }
  path.lying_speed /= static_cast<double>(lying);
  double before = 0;
  bool any = false;
  for (std::size_t i = 0; i + k_chord < middle.size(); i += k_chord) {
    const Eigen::Vector3d along = middle[i + k_chord] - middle[i];
    if (along.head<2>().norm() < spacing) continue;  // what hangs
    const double angle = std::atan2(along.y(), along.x());
    const double turn = std::remainder(angle - before, 2 * k_pi) / (2 * k_pi);
    if (any) path.turns += turn, path.bends += std::abs(turn);
    before = angle;
    any = true;
  }
  return path;
}

// One second and a half of it: the strand has lain down in coils and on itself by then. That it becomes one
// where it lies on itself no event tells, as it is one piece all the while, but the regions of shape matching
// do: they reach across what has merged, so that they hold more particles.
TEST(toothpaste, is_one_strand_that_coils_merges_with_itself_and_keeps_its_volume) {
  Scene scene = read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/toothpaste.toml");
  scene.surface.particle_radius = 0.5f;
  Simulation s = build(scene, 2);
  const double h = static_cast<double>(scene.emitters[0].spacing);
  Surfacer surfacer(scene.surface, 2);
  const double neighbors = s.info().bodies[0].average_neighbors;
  double next = 0.5;
  while (s.time() < 1.5) {
    s.step();
    for (const BodyEvent& event : s.events())
      ASSERT_NE(event.kind, BodyEvent::Kind::torn) << "into " << event.parts << " parts at " << s.time();
    if (s.time() < next) continue;
    next += 0.5;
    const double volume = h * h * h * static_cast<double>(s.particle_count());
    ASSERT_NEAR(signed_volume(surfacer.draw(surface_particles(s))) / volume, 1, 0.05) << s.time();
  }
  ASSERT_EQ(s.particle_count() % k_layer, 0u);
  const Path path = path_of(s, k_layer, h);
  EXPECT_GT(path.turns, 1) << "it winds";
  EXPECT_LT(path.bends - path.turns, 0.1) << "one way, as a coil does and a fold does not";
  // Without yield it winds as it slides: 0.25 of the speed at which it comes out.
  EXPECT_LT(path.lying_speed, 0.05 * static_cast<double>(scene.emitters[0].speed.at(0)))
      << "it stays where it lies";
  EXPECT_GT(s.info().bodies[0].average_neighbors, 1.08 * neighbors) << "it merges with itself";
}

}  // namespace toothpaste_test
}  // namespace mallow

// The scene data/scenes/toothpaste.toml: an emitter, plastic yield and the volume constraint together.
#include <gtest/gtest.h>

#include "mallow/scene.h"
#include "mallow/simulation.h"
#include "mallow/surface.h"
#include "meshes.h"

namespace mallow {
namespace toothpaste_test {

// One second and a half of it: the strand has lain down in coils and on itself by then. That it becomes one
// where it lies on itself no event tells, as it is one piece all the while, but the regions of shape matching
// do: they reach across what has merged, so that they hold more particles.
TEST(toothpaste, is_one_strand_that_coils_merges_with_itself_and_keeps_its_volume) {
  Scene scene = read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/toothpaste.toml");
  scene.surface.particle_radius = 0.5f;
  Simulation s = build(scene, 2);
  const double h = static_cast<double>(scene.emitters[0].spacing);
  const float diameter = 2 * *scene.emitters[0].radius;
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
  const Aabb box = s.bounds(*s.find_body("emitter[0]"));
  EXPECT_GT((box.max - box.min).head<2>().minCoeff(), 3 * diameter) << "it coils";
  EXPECT_GT(s.info().bodies[0].average_neighbors, 1.08 * neighbors) << "it merges with itself";
}

}  // namespace toothpaste_test
}  // namespace mallow

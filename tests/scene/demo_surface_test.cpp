#include <gtest/gtest.h>

#include "level_set/meshes.h"
#include "mallow/files.h"
#include "mallow/level_set.h"
#include "mallow/scene.h"
#include "mallow/simulation.h"

namespace mallow {
namespace demo_surface_test {

TEST(demo, surface_is_closed_and_turned_outwards_on_every_frame) {
  const Scene scene = read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/demo.toml");
  Simulation simulation = build(scene, 2);
  std::vector<float> spacings;
  for (const BodyInfo& body : simulation.info().bodies) spacings.push_back(body.spacing);
  Surfacer surfacer(scene.surface, 2);
  for (int frame = 0; frame <= scene.run.frames; ++frame) {
    const ParticleFrame now = snapshot(simulation);
    const Mesh& mesh = surfacer.draw({now.positions, now.velocities, now.groups, spacings});
    ASSERT_EQ(why_not_closed(mesh), "") << "frame " << frame;
    ASSERT_GT(signed_volume(mesh), 0) << "frame " << frame;
    simulation.advance(frame_time(scene, simulation.info()));
  }
}

}  // namespace demo_surface_test
}  // namespace mallow

#include <gtest/gtest.h>

#include "mallow/scene.h"
#include "mallow/simulation.h"
#include "mallow/surface.h"
#include "meshes.h"

namespace mallow {
namespace demo_surface_test {

TEST(demo, surface_is_closed_and_turned_outwards_on_every_frame) {
  const Scene scene = read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/demo.toml");
  Simulation simulation = build(scene, 2);
  Surfacer surfacer(scene.surface, 2);
  for (int frame = 0; frame <= scene.run.frames; ++frame) {
    const Mesh& mesh = surfacer.draw(surface_particles(simulation));
    ASSERT_EQ(why_not_closed(mesh), "") << "frame " << frame;
    ASSERT_GT(signed_volume(mesh), 0) << "frame " << frame;
    simulation.advance(frame_time(scene, simulation.info()));
  }
}

}  // namespace demo_surface_test
}  // namespace mallow

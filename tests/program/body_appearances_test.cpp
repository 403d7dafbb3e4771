// How bodies look that come while a run goes on.
#include <gtest/gtest.h>

#include "mallow/scene.h"
#include "program/body_appearances.h"

namespace mallow::program {
namespace body_appearances_test {

const char* const k_scene = R"(
[[material]]
name = "red"
color = [0.8, 0.1, 0.1]
[[material]]
name = "blue"
color = [0.1, 0.1, 0.8]
[[body]]
material = "red"
box = { count = [3, 3, 3], spacing = 1.0, corner = [20, 0, 0], jitter = 0 }
[[body]]
material = "blue"
splits = true
box = { count = [12, 3, 3], spacing = 1.0, corner = [0, 0, 0], jitter = 0 }
)";

TEST(body_appearances,
     of_parts_that_were_torn_off_are_those_of_their_material_and_reports_list_them_by_slot) {
  const Scene scene = parse_scene(k_scene, "scene.toml");
  Simulation simulation = build(scene, 1);
  std::vector<BodyInfo> bodies;
  EXPECT_TRUE(follow_bodies(simulation, bodies));
  EXPECT_FALSE(follow_bodies(simulation, bodies));
  ASSERT_EQ(bodies.size(), 2u);
  simulation.step();
  simulation.remove_particles(Aabb{{4, -9, -9}, {8, 9, 9}});
  simulation.remove_body(simulation.bodies().front());
  simulation.step();
  simulation.step();
  ASSERT_EQ(simulation.body_count(), 2u) << "both parts of the blue one";
  follow_bodies(simulation, bodies);
  const BodyId part = simulation.bodies().back();
  ASSERT_GT(bodies.size(), slot_of(part));
  EXPECT_EQ(bodies[slot_of(part)].particles, 36u);
  const std::vector<Appearance> looks = body_appearances(scene, material_names(bodies));
  ASSERT_EQ(looks.size(), bodies.size());
  EXPECT_EQ(looks[1].color, *scene.materials[1].color);
  EXPECT_EQ(looks[slot_of(part)].color, *scene.materials[1].color) << "whose slot a red one had";
}

TEST(body_appearances, of_what_no_scene_has_are_of_their_own) {
  const Scene scene = parse_scene(k_scene, "scene.toml");
  const std::vector<std::string> materials = {"red", "blue", "blue", "a ball", ""};
  const std::vector<Appearance> looks = body_appearances(scene, materials);
  ASSERT_EQ(looks.size(), 5u);
  EXPECT_EQ(looks[2].color, *scene.materials[1].color);
  EXPECT_EQ(looks[3].color, looks[4].color);
  EXPECT_NE(looks[3].color, looks[1].color);
}

}  // namespace body_appearances_test
}  // namespace mallow::program
